// The options of a picture, for the command line and for callers of the library. The defaults are
// those of the command line, except two that docs/library.md names.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dapple/bias.hpp"
#include "dapple/device.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// Default footprint scale, chosen from a curve of bias, noise and time. docs/accuracy.md has the
/// bias of many scenes; the mean of AO is mostly below 0.003, and 0.008 in grass.
inline constexpr float kDefaultFootprint = 4.0f;
/// Of occlusion(): with as many rays a point less RMSE, in less time, than with kDefaultFootprint.
inline constexpr float kOcclusionFootprint = 8.0f;

/// How the transmittance of an occlusion ray is estimated.
enum class Estimator : std::uint8_t {
  exact,        ///< every surface on the ray is composited
  prefiltered,  ///< stops at BVH nodes that the ray's footprint covers
};

/// On which normals the hemisphere of a surface stands.
enum class Normals : std::uint8_t {
  shading,    ///< those of the mesh, interpolated; of the faces where it has none
  geometric,  ///< those of the faces
};

/// The value's name on the command line.
std::string name_of(Normals normals);
std::string name_of(Estimator estimator);
std::string name_of(Packets packets);

/// The largest number of rays of one kind for a pixel: `spp` or `max_spp` times the rays of a
/// sample. Sums are 64-bit fixed-point numbers with 24 bits for the number of rays.
inline constexpr int kMaxRaysOfPixel = 1 << 24;

/// A pixel rectangle, inclusive at both ends as in EXR windows; (0,0) is top left.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
  [[nodiscard]] int width() const { return x1 - x0 + 1; }
  [[nodiscard]] int height() const { return y1 - y0 + 1; }
  bool operator==(const PixelRect&) const = default;
};

/// Which Cryptomatte layers to make.
struct Cryptomattes {
  bool objects = false;    ///< by name_objects()
  bool materials = false;  ///< by Material::name
  [[nodiscard]] bool any() const { return objects || materials; }
};

/// As --cryptomatte has it; "none" for none.
std::string name_of(const Cryptomattes& mattes);

/// A part of a picture's samples, for one of several machines: of `count` parts that are equal up
/// to one camera ray a pixel, the one with the number `index`, counted from 1.
struct Shard {
  int index = 1, count = 1;
};

struct LookAt {
  V3f from{0, 0, 0};
  V3f at{0, 0, -1};
  V3f up{0, 1, 0};
};

struct RenderOptions {
  int width = 960;   ///< pixels, [1, 65535]
  int height = 540;  ///< pixels, [1, 65535]
  /// Camera rays a pixel, [1, 2^20]. With a target it is the minimum, rounded up to whole
  /// batches of four, at least two batches.
  int spp = 16;
  /// Sample each pixel until its estimated standard error is below this, [0, 1]; 0: no target.
  /// Errors of lights are relative to their largest unoccluded irradiance.
  float target_error = 0;
  /// Sample until the estimated root mean square of the pixels' errors is below this in every pass,
  /// [0, 1]; 0: no target. Not together with target_error.
  float target_rmse = 0;
  /// Camera rays a pixel that footprints are computed for, [1, 2^20]; 0: footprint_samples()
  /// chooses. A resumed render keeps the number of the first run, so that more samples estimate the
  /// same picture.
  int footprint_spp = 0;
  int footprint_ao_rays = 0;  ///< AO rays a camera ray, in the same way, [1, 4096]; 0: ao_rays
  /// The samples that are traced. `spp` is that of all shards together, for which footprints are
  /// computed. Not together with a target.
  Shard shard;
  int max_spp = 4096;  ///< with a target, the maximum of camera rays a pixel, [spp, 2^20]
  /// Samples that share a camera ray, 1, 2 or 4. Each sample chooses its own surface among those
  /// that the ray intersects. Larger values suit thin leaves and hair; 0: chosen from the scene's
  /// opacities. `spp` and `max_spp` count camera rays.
  int camera_splitting = 0;
  /// AO rays a camera ray, [1, 4096], at least one for each sample that shares a camera ray
  /// (two: experiment 516).
  int ao_rays = 2;
  int light_rays = 1;  ///< rays a light and sample, [1, 4096]; samples can share a camera ray
  Estimator estimator = Estimator::prefiltered;
  float footprint = kDefaultFootprint;  ///< scale, [0, 10^6]; 0 is exact
  /// With Estimator::exact: rays whose transmittance T is below this end at random; those that do
  /// not, a share of T / roulette, count as rays of this transmittance. [0, 1); 0: none ends, as in
  /// reports of the bias. Pictures have the same mean, sooner, with a little more noise
  /// (kernels/occlusion/roulette.clh, experiment 359).
  float roulette = 0.25f;
  /// Share of the prefiltered rays that are traced exactly, too, to report the bias, [0,1]; 0:
  /// none. It changes no value of the film.
  float report_bias = kDefaultReportBias;
  /// Take the largest of `footprint`, a half of it, a quarter and so on with which the bias of
  /// every layer, two standard errors included, is at most this, [0,1]; exact rays if none is; 0:
  /// take `footprint`. None: kDefaultMaxBias in a picture of kMinPilotSamples samples and more,
  /// where a small part of the rays is enough to tell that `footprint` has more. So give 0 to keep
  /// `footprint`, as for frames that must be alike.
  std::optional<float> max_bias = {};
  /// Take `footprint` whatever its bias, as later frames of a sequence do. With a target its bias
  /// is still measured.
  bool keep_footprint = false;
  Normals normals = Normals::shading;
  bool ao = true;       ///< make the AO pass
  bool light = true;    ///< make the light passes
  bool albedo = true;   ///< make the layer of colours; SceneOptions::colors reads them
  bool beauty = false;  ///< make layers of what the sky adds to RGB, and, with `light`, each light
  bool back = false;    ///< make layers of what reaches the other side of surfaces
  /// With `back`: one in so many samples is traced on that side, too, a power of two in [1, 64].
  /// With the default a render takes about 1.1 times as long, and layers of the other side have
  /// 4 times the noise of those in front, more at edges; with 1 up to 1.7 times, the same noise.
  int back_every = 16;
  bool visits = false;  ///< make layers of node visits and triangle tests
  /// Make layers of motion vectors. Only Renderer::render_shutter() can: it takes the next frame.
  bool motion = false;
  Cryptomattes cryptomattes;
  bool deep = false;         ///< make Film::deep
  float ao_distance = 0.0f;  ///< metres, [0, 1e30]; 0 is no limit
  float ao_falloff = 0.0f;   ///< p of (1 - t/D)^p, [0, 100]; 0 is a hard limit
  /// Radiance of a uniform sky that is multiplied by AO in RGBA, [0, 1e30]; none: 1 without lights,
  /// 0 with a dome, otherwise a tenth of what the lights make of bright white surfaces: of the 90th
  /// percentile, over pixels whose surfaces face a light, of irradiance without occlusion.
  std::optional<float> ambient = {};
  std::string camera = {};  ///< by name; empty: the first, or one that shows it all
  std::optional<LookAt> look = {};
  float fov_degrees = 0.0f;  ///< vertical, [0.01, 179]; 0: the camera's own, or 40 with `look`
  /// Radius of the lens, metres, [0, 1e6]; none: the camera's own.
  std::optional<float> aperture = {};
  /// Metres along the view direction, (0, 1e12]; none: the camera's own, the point that `look`
  /// looks at, or the middle of the scene. Needs a lens.
  std::optional<float> focus_distance = {};
  std::optional<PixelRect> crop = {};
  std::uint32_t seed = 0;
  std::string device = {};  ///< part of an OpenCL device's name; empty: the best one
  Packets packets = Packets::automatic;
  std::string kernel_dir = {};  ///< read kernels from this folder instead of the built-in ones
  std::string cache = {};       ///< keep built BVHs in this folder and reuse them; empty: don't
  bool ground = false;          ///< put an opaque plane under the scene
  /// The plane's y with `ground`, metres, [-1e12, 1e12]; none: a little below the lowest point.
  std::optional<float> ground_height = {};
  std::vector<std::pair<std::string, float>> opacity = {};  ///< material name, opacity in [0,1]
};

/// Whether the number of samples differs from pixel to pixel, because a target is set.
[[nodiscard]] inline bool is_adaptive(const RenderOptions& options) {
  return options.target_error > 0 || options.target_rmse > 0;
}

/// Samples a pixel that footprints are computed for: `footprint_spp` if it is set, else `spp`. With
/// a target it returns at least `spp`, and so many samples that the bias over visible surfaces
/// stays below about a third of target_error, or half of target_rmse.
[[nodiscard]] int footprint_samples(const RenderOptions& options);

/// Whether a picture has a bias: whether its rays are prefiltered.
[[nodiscard]] inline bool has_bias(const RenderOptions& options) {
  return options.estimator == Estimator::prefiltered && options.footprint > 0 &&
         (options.ao || options.light);
}

/// The bias that a picture may have if RenderOptions::max_bias does not say.
inline constexpr float kDefaultMaxBias = 0.002f;
/// With fewer samples, or more pixels, the choice would take too large a part of the time.
inline constexpr double kMinPilotSamples = 1 << 20, kMaxPilotPixels = 1 << 27;

/// Whether the footprint is chosen without a limit of bias or a target being given.
[[nodiscard]] inline bool chooses_footprint(const RenderOptions& options) {
  const double pixels = double{1} * options.width * options.height;
  return has_bias(options) && !options.keep_footprint && !options.max_bias &&
         !is_adaptive(options) && pixels * options.spp >= kMinPilotSamples &&
         pixels <= kMaxPilotPixels;
}

/// Whether RenderOptions::max_bias limits the footprint.
[[nodiscard]] inline bool limits_bias(const RenderOptions& options) {
  return options.max_bias > 0 && !options.keep_footprint;
}

/// Whether rays are traced exactly, too: for the report, for the choice of a footprint or for a
/// target.
[[nodiscard]] inline bool measures_bias(const RenderOptions& options) {
  return has_bias(options) && (options.report_bias > 0 || limits_bias(options) ||
                               is_adaptive(options) || chooses_footprint(options));
}

/// The RMSE of a picture for which footprints of footprint_samples() samples are meant, [0,1].
[[nodiscard]] float footprint_rmse(const RenderOptions& options);

/// AO rays a camera ray that divide the hemisphere into footprints.
[[nodiscard]] inline int footprint_ao_rays(const RenderOptions& options) {
  return options.footprint_ao_rays > 0 ? options.footprint_ao_rays : options.ao_rays;
}

/// Throws Error usage, which names the command line's flag, if a value is out of range.
void validate(const RenderOptions& options);

}  // namespace dapple
