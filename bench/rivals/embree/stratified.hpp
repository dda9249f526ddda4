// Stratified points and directions for Embree's rays. In: pixels or points, and indices of samples.
// Out: the sequences of kernels/sampling/random.clh (for each pixel and dimension pair an
// Owen-scrambled Sobol (0,2) sequence), so that both programs use samples of the same quality at
// the same cost. Plain loops over floats, which the compiler vectorizes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dapple::bench {

/// Dimension pairs of a pixel or shading point; light l uses kLightPair + l.
inline constexpr std::uint32_t kPixelPair = 0, kAoPair = 1, kLightPair = 2,
                               kAoRotationPair = 0xfffffffeu;

/// 32 bits with full avalanche (the lowbias32 constants found by C. Wellons).
inline std::uint32_t hash_uint(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

inline std::uint32_t hash_pair(std::uint32_t a, std::uint32_t b) {
  return hash_uint(a * 0x9e3779b1u + hash_uint(b));
}

/// The upper 24 bits as a number in [0,1).
inline float unit_float(std::uint32_t bits) {
  return static_cast<float>(static_cast<std::int32_t>(bits >> 8)) * (1.0f / 16777216.0f);
}

/// Random bits of a ray for stochastic opacity.
inline std::uint32_t ray_key(std::uint32_t pixel, std::uint32_t index, std::uint32_t pair,
                             std::uint32_t seed) {
  return hash_pair(hash_pair(pixel, pair ^ 0x5851f42du), hash_pair(index, seed));
}

/// Points `index[i]` of the sequences of `pixel[i]`, in [0,1)^2.
void sample_squares(const std::uint32_t* pixel, const std::uint32_t* index, unsigned count,
                    std::uint32_t pair, std::uint32_t seed, float* x, float* y);

/// ray_key() of each ray.
void ray_keys(const std::uint32_t* pixel, const std::uint32_t* index, unsigned count,
              std::uint32_t pair, std::uint32_t seed, std::uint32_t* keys);

/// Points of the unit disk: for each i, point `index[i]` of the Vogel spiral of `rays` points that
/// belongs to `point[i]`, as vogel_disk() of kernels/sampling/direction.clh computes it. On entry
/// `x` holds the jitter within each point's ring, [0,1).
void vogel_points(const std::uint32_t* point, const std::uint32_t* index, unsigned count,
                  std::size_t rays, std::uint32_t seed, float* x, float* y);

/// Maps points of the unit disk to cosine-weighted unit directions about unit normals. The arrays
/// must not overlap.
void lift_to_directions(const float* x, const float* y, const float* const normal[3],
                        unsigned count, float* const direction[3]);

/// The same for points of the unit square.
void cosine_directions(const float* x, const float* y, const float* const normal[3], unsigned count,
                       float* const direction[3]);

}  // namespace dapple::bench
