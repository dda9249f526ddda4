// The running sums of a picture on the device: 64-bit fixed point planes, and how they
// become a Film. The planes' order is that of kernels/film/film.cl.
#pragma once

#include <vector>

#include "dapple/film.hpp"
#include "dapple/wavefront.hpp"
#include "device/context.hpp"
#include "camera/view.hpp"

namespace dapple {

inline constexpr std::uint32_t kSurfacePlanes = 10;
inline constexpr std::uint32_t kAoPlanes = 6;

/// The plane of camera rays' visits; that of their tests is next, as everywhere.
inline constexpr std::uint32_t kCameraVisits = 8;

/// A light's planes: irradiance and the same unoccluded, each of 1 channel, of a dome 3; then
/// visits and tests.
struct LightPlaneRange {
  std::uint32_t first = 0;
  std::uint32_t channels = 1;
  [[nodiscard]] std::uint32_t unoccluded() const { return first + channels; }
  [[nodiscard]] std::uint32_t visits() const { return first + 2 * channels; }
  [[nodiscard]] constexpr std::uint32_t count() const { return 2 * channels + 2; }
};

/// First plane of each pass, and the powers of two by which values are scaled. A sum of
/// 2^24 samples of the largest value still fits 63 bits.
struct FilmLayout {
  std::uint32_t pixels = 0;
  std::uint32_t plane_count = 0;
  std::uint32_t ao = 0;  ///< first AO plane
  std::vector<LightPlaneRange> lights;
  std::uint32_t squares = 0;  ///< planes of squares: two of AO, then two a light
  float unit_scale = 0;       ///< of values up to 1
  float light_scale = 0;      ///< of irradiance at radiance 1, up to 1024 pi
  float position_scale = 0;
  float depth_scale = 0;

  FilmLayout(const View& view, const RenderOptions& options, const Box3f& bounds,
             const std::vector<Light>& lights);
  [[nodiscard]] std::uint32_t ao_visits() const { return ao + 4; }
  /// First plane of squares of a light, of batches; that of pairs is next. AO's is 0.
  [[nodiscard]] std::uint32_t light_squares(std::size_t light) const {
    return 2 * (static_cast<std::uint32_t>(light) + (ao ? 1u : 0u));
  }
  [[nodiscard]] std::size_t sum_bytes() const {
    return std::size_t{pixels} * plane_count * sizeof(std::int64_t);
  }
  [[nodiscard]] std::size_t square_bytes() const {
    return std::size_t{pixels} * squares * sizeof(float);
  }
};

struct TracedPicture;

/// Means of the sums as the planes an EXR gets (channel names as docs/layers.md lists them);
/// also the visit counts, into `statistics`.
std::vector<Plane> develop(const TracedPicture& picture, const FilmLayout& layout,
                           const RenderOptions& options, const std::vector<Light>& lights,
                           RenderStatistics& statistics);

}  // namespace dapple
