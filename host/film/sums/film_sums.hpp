// The layout of an image's running sums on the device, planes of 64-bit fixed point. In: view,
// options and lights. Out: the position of each plane and its scale. The order of planes is that of
// film_planes.h. layers.hpp converts the sums into EXR layers.
#pragma once

#include <span>
#include <vector>

#include "camera/view.hpp"
#include "dapple/render.hpp"
#include "dapple/shared/film_planes.h"
#include "dapple/shared/light_record.h"
#include "device/context.hpp"

namespace dapple {

/// A light's planes: irradiance with occlusion, then without, each of 1 channel (3 for a dome);
/// then node visits and triangle tests; then, with albedo, what is reflected (3).
struct LightPlaneRange {
  std::uint32_t first = 0;
  std::uint32_t channels = 1;
  float scale = 0;  ///< for irradiance at radiance 1
  [[nodiscard]] std::uint32_t unoccluded() const { return first + channels; }
  [[nodiscard]] std::uint32_t visits() const { return first + 2 * channels; }
  [[nodiscard]] std::uint32_t reflected() const { return visits() + 2; }
};

/// Powers of two that positions, depths and irradiances are multiplied by.
struct FilmScales {
  float position = 0, depth = 0;
  std::vector<float> lights;
};

/// Returns the scales for a scene in `bounds` and its lights. The irradiance of a light of radiance
/// 1 at the farthest point of `bounds` has 28 bits, so that what a dark surface reflects of it has
/// enough, or fewer, 12 if possible, if what it gives the nearest point would become too large.
/// `at_others`: the lights at other moments of a shutter, one moment after the other.
FilmScales film_scales(const View& view, const Box3f& bounds, std::span<const LightRecord> lights,
                       std::span<const LightRecord> at_others = {});

/// Lights that share a layer, and the luminances of their radiances.
struct LightGroup {
  std::vector<std::size_t> lights;
  std::vector<double> luminances;
};

/// The first plane of each pass, and the powers of two that values are multiplied by. The sum of
/// 2^24 samples of the largest value fits 63 bits. Irradiances have no largest value: their sums
/// stop at 2^61 in a slice and at the largest number in all.
struct FilmLayout {
  std::uint32_t width = 0;  ///< of the crop, pixels
  std::uint32_t pixels = 0;
  std::uint32_t plane_count = 0;
  std::uint32_t ao = 0;       ///< first AO plane
  std::uint32_t normals = 0;  ///< first plane of shading normals; 0: there are none
  std::uint32_t albedo = 0;   ///< first of three planes, or 0
  std::vector<LightPlaneRange> lights;
  std::vector<LightGroup> groups;  ///< of two lights or more, in the order of light_layers()
  /// Planes of the number of samples whose backs are traced, and of those that hit; 0: none are.
  std::uint32_t back_samples = 0;
  std::uint32_t back_ao = 0;  ///< the backs' plane of transmittance, or 0
  /// The first plane of each light's irradiance with occlusion on the backs.
  std::vector<std::uint32_t> back_lights;
  std::uint32_t squares = 0;  ///< number of planes of squares: two for AO, two for each light
  float unit_scale = 0;       ///< for values up to 1
  float position_scale = 0;
  float depth_scale = 0;

  /// `scales` has one for each of `lights`, or more.
  FilmLayout(const PixelRect& crop, const RenderOptions& options, const FilmScales& scales,
             const std::vector<Light>& lights, bool has_normals = false);
  /// The first plane of the shading pass; 0: there is no such pass.
  [[nodiscard]] std::uint32_t shading() const { return normals ? normals : albedo; }
  [[nodiscard]] std::uint32_t ao_visits() const { return ao + DAPPLE_PLANE_AO_VISITS; }
  /// The first of three planes of transmittance times albedo; there with `albedo` and `ao`.
  [[nodiscard]] std::uint32_t ao_reflected() const { return ao + DAPPLE_AO_PLANES; }
  /// The plane of a light's squared means of sample batches. The next plane is for pairs of
  /// batches. AO's planes are 0 and 1.
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

}  // namespace dapple
