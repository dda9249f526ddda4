#include "rivals/embree/stratified.hpp"

#include <cmath>
#include <numbers>

#include "bvh/build/multiversion.hpp"

namespace dapple::bench {
namespace {

inline std::uint32_t reversed(std::uint32_t x) {
  x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
  x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
  x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
  x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
  return x >> 16 | x << 16;
}

/// An Owen scramble of a number whose bits are reversed (Laine and Karras, "Stratified Sampling
/// for Stochastic Transparency", 2011; constants of Burley, "Practical Hash-based Owen
/// Scrambling", 2020).
inline std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  return x ^ x * 0x8d22f6e6u;
}

/// The second Sobol dimension with reversed bits: Pascal's triangle modulo 2, times the index.
inline std::uint32_t sobol_second(std::uint32_t index) {
  index ^= (index & 0xaaaaaaaau) >> 1;
  index ^= (index & 0xccccccccu) >> 2;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xff00ff00u) >> 8;
  return index ^ index >> 16;
}

/// Taylor series; exact to 4e-7 up to pi / 4.
inline float sine(float a) {
  const float s = a * a;
  return a * (1.0f + s * (-1.0f / 6 + s * (1.0f / 120 + s * (-1.0f / 5040))));
}

inline float cosine(float a) {
  const float s = a * a;
  return 1.0f + s * (-1.0f / 2 + s * (1.0f / 24 + s * (-1.0f / 720 + s * (1.0f / 40320))));
}

/// Maps the unit square to the disk: Shirley and Chiu, "A Low Distortion Map Between Disk and
/// Square", 1997.
struct Concentric {
  void operator()(float x, float y, float& u, float& v) const {
    constexpr float kQuarterPi = std::numbers::pi_v<float> / 4;
    const float a = 2.0f * x - 1.0f, b = 2.0f * y - 1.0f;
    const bool a_larger = std::fabs(a) > std::fabs(b);
    const float radius = a_larger ? a : b, other = a_larger ? b : a;
    const float angle = kQuarterPi * (other / (radius == 0.0f ? 1.0f : radius));
    const float along = radius * cosine(angle), across = radius * sine(angle);
    u = a_larger ? along : across;
    v = a_larger ? across : along;
  }
};

struct OnDisk {
  void operator()(float x, float y, float& u, float& v) const {
    u = x;
    v = y;
  }
};

/// The frame is that of Duff et al., "Building an Orthonormal Basis, Revisited", 2017.
///
/// Outputs are restrict parameters, because the compiler checks at most ten pairs of arrays for
/// overlap, and keeps the promise of restrict only for parameters when it inlines the function.
template <class ToDisk>
inline void fill_cosine_directions(const ToDisk& to_disk, const float* x, const float* y,
                                   const float* nx, const float* ny, const float* nz,
                                   unsigned count, float* __restrict dx, float* __restrict dy,
                                   float* __restrict dz) {
  for (unsigned i = 0; i < count; ++i) {
    float u, v;
    to_disk(x[i], y[i], u, v);
    const float square = 1.0f - u * u - v * v;
    const float w = std::sqrt(square > 1e-8f ? square : 1e-8f);
    const float s = nz[i] >= 0.0f ? 1.0f : -1.0f;
    const float c = -1.0f / (s + nz[i]), d = nx[i] * ny[i] * c;
    dx[i] = u * (1.0f + s * nx[i] * nx[i] * c) + v * d + w * nx[i];
    dy[i] = u * (s * d) + v * (s + ny[i] * ny[i] * c) + w * ny[i];
    dz[i] = u * (-s * nx[i]) + v * -ny[i] + w * nz[i];
  }
}

}  // namespace

DAPPLE_MULTIVERSION
void sample_squares(const std::uint32_t* pixel, const std::uint32_t* index, unsigned count,
                    std::uint32_t pair, std::uint32_t seed, float* x, float* y) {
  for (unsigned i = 0; i < count; ++i) {
    const std::uint32_t key = hash_pair(hash_pair(pixel[i], pair), seed);
    const std::uint32_t order = reversed(scrambled(reversed(index[i]), key));
    x[i] = unit_float(reversed(scrambled(order, hash_uint(key ^ 0xa511e9b3u))));
    y[i] = unit_float(reversed(scrambled(sobol_second(order), hash_uint(key ^ 0x63d83595u))));
  }
}

DAPPLE_MULTIVERSION
void ray_keys(const std::uint32_t* pixel, const std::uint32_t* index, unsigned count,
              std::uint32_t pair, std::uint32_t seed, std::uint32_t* keys) {
  for (unsigned i = 0; i < count; ++i) keys[i] = ray_key(pixel[i], index[i], pair, seed);
}

DAPPLE_MULTIVERSION
void cosine_directions(const float* x, const float* y, const float* const normal[3], unsigned count,
                       float* const direction[3]) {
  fill_cosine_directions(Concentric{}, x, y, normal[0], normal[1], normal[2], count, direction[0],
                         direction[1], direction[2]);
}

DAPPLE_MULTIVERSION
void lift_to_directions(const float* x, const float* y, const float* const normal[3],
                        unsigned count, float* const direction[3]) {
  fill_cosine_directions(OnDisk{}, x, y, normal[0], normal[1], normal[2], count, direction[0],
                         direction[1], direction[2]);
}

DAPPLE_MULTIVERSION
void vogel_points(const std::uint32_t* point, const std::uint32_t* index, unsigned count,
                  std::size_t rays, std::uint32_t seed, float* x, float* y) {
  constexpr float kQuarterTurn = std::numbers::pi_v<float> / 2;
  constexpr float kQuarter = 0x1p30f;
  const float inverse_count = 1.0f / static_cast<float>(rays);
  for (unsigned i = 0; i < count; ++i) {
    const std::uint32_t turn = hash_pair(hash_pair(point[i], kAoRotationPair), seed);
    const std::uint32_t from_corner = turn + index[i] * 1640531527u + 0x20000000u;
    const std::uint32_t quarter = from_corner >> 30;
    const auto along = static_cast<std::int32_t>(from_corner & 0x3fffffffu) - 0x20000000;
    const float angle = static_cast<float>(along) * (kQuarterTurn / kQuarter);
    const float s = sine(angle), c = cosine(angle);
    const float across = (quarter & 1u) != 0 ? s : c, up = (quarter & 1u) != 0 ? c : s;
    const float ring = static_cast<float>(static_cast<std::int32_t>(index[i])) + x[i];
    const float radius = std::sqrt(ring * inverse_count);
    x[i] = radius * (quarter == 1 || quarter == 2 ? -across : across);
    y[i] = radius * (quarter >= 2 ? -up : up);
  }
}

}  // namespace dapple::bench
