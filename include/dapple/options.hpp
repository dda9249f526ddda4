// Everything that decides a picture, filled by the command line and by callers of the
// library alike. Defaults are those of the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dapple/device.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// Footprint scale of all defaults, from a curve of bias, noise and time (docs/accuracy.md): mean
/// biases of AO are within 0.006 here, but for the outside of dense hair.
inline constexpr float kDefaultFootprint = 4.0f;

/// How an occlusion ray is estimated.
enum class Estimator : std::uint8_t {
  exact,        ///< every surface on the ray is composited
  prefiltered,  ///< stops at BVH nodes that the ray's footprint covers
};

/// As the command line spells it.
std::string name_of(Estimator estimator);
std::string name_of(Packets packets);

/// Rays of one kind that a pixel may have at most, `spp` or `max_spp` times those of a sample: sums
/// are kept in 64-bit fixed point with 24 bits to spare.
inline constexpr int kMaxRaysOfPixel = 1 << 24;

/// A pixel rectangle, inclusive at both ends as in EXR windows; (0,0) is top left.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
  [[nodiscard]] int width() const { return x1 - x0 + 1; }
  [[nodiscard]] int height() const { return y1 - y0 + 1; }
  bool operator==(const PixelRect&) const = default;
};

struct LookAt {
  V3f from{0, 0, 0};
  V3f at{0, 0, -1};
  V3f up{0, 1, 0};
};

struct RenderOptions {
  int width = 960;   ///< pixels, [1, 65535]
  int height = 540;  ///< pixels, [1, 65535]
  /// Primary samples a pixel, [1, 2^20]; with a target the minimum, rounded up to whole batches of
  /// four, at least two.
  int spp = 16;
  /// Sample each pixel until its estimated standard error is below this, [0, 1]; 0: no target.
  /// Errors of lights are relative to their largest unoccluded irradiance.
  float target_error = 0;
  /// Sample until the estimated root mean square of the pixels' errors is below this in every pass,
  /// [0, 1]; 0: no target. Not together with target_error.
  float target_rmse = 0;
  /// Samples a pixel that footprints are made for, [1, 2^20]; 0: spp. A render that resumes from a
  /// checkpoint keeps those of its beginning, so that more samples estimate the same picture.
  int footprint_spp = 0;
  int footprint_ao_rays = 0;  ///< the same of AO rays a primary sample, [1, 4096]; 0: ao_rays
  int max_spp = 4096;         ///< with a target the most samples a pixel, [spp, 2^20]
  /// Samples that share a camera ray, 1, 2 or 4: each is shaded at a surface of its own among those
  /// that the ray crosses. More suit thin leaves and hair; 0: chosen by the scene's opacities.
  /// `spp` and `max_spp` count camera rays.
  int camera_splitting = 0;
  /// AO rays a primary sample, [1, 4096], at least one for each sample that shares a camera ray
  /// (two: experiment 516).
  int ao_rays = 2;
  int light_rays = 1;  ///< rays a light and primary sample, [1, 4096]
  Estimator estimator = Estimator::prefiltered;
  float footprint = kDefaultFootprint;  ///< scale, >= 0; 0 is exact
  bool ao = true;                       ///< make the AO pass
  bool light = true;                    ///< make the light passes
  bool visits = false;                  ///< make layers of what rays cost
  float ao_distance = 0.0f;             ///< metres; 0 is no limit
  float ao_falloff = 0.0f;              ///< p of (1 - t/D)^p, >= 0; 0 is a hard limit
  std::string camera;                   ///< by name; empty: the first, or one that frames the scene
  std::optional<LookAt> look;
  float fov_degrees = 0.0f;  ///< vertical; 0: the camera's own, or 40 with `look`
  std::optional<PixelRect> crop;
  std::uint32_t seed = 0;
  std::string device;  ///< part of an OpenCL device's name; empty: the best one
  Packets packets = Packets::automatic;
  std::string kernel_dir;  ///< read kernels from this folder instead of the built-in ones
  std::string cache;       ///< keep built BVHs in this folder and reuse them; empty: don't
  bool ground = false;     ///< put an opaque plane under the scene
  std::vector<std::pair<std::string, float>> opacity;  ///< material name, opacity in [0,1]
};

/// Whether pixels get as many samples as they need, by one of the two targets.
[[nodiscard]] inline bool is_adaptive(const RenderOptions& options) {
  return options.target_error > 0 || options.target_rmse > 0;
}

/// Samples a pixel whose shares footprints begin with: `footprint_spp` if there is one; else `spp`,
/// and with a target so many that the bias over what is seen stays below about a third of a pixel's
/// error, half of a picture's.
[[nodiscard]] int footprint_samples(const RenderOptions& options);

/// The RMSE of a picture that footprints of so many samples are for, [0,1].
[[nodiscard]] float footprint_rmse(const RenderOptions& options);

/// AO rays a primary sample among which footprints share the hemisphere.
[[nodiscard]] inline int footprint_ao_rays(const RenderOptions& options) {
  return options.footprint_ao_rays > 0 ? options.footprint_ao_rays : options.ao_rays;
}

/// Throws Error usage, naming the command line's flag, when a value is out of range.
void validate(const RenderOptions& options);

}  // namespace dapple
