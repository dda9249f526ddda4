// The engine: render() and Renderer make films of scenes; occlusion() and irradiance() return
// values at points of the caller; trace() and closest_hits() take its rays, for tests and benches.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dapple/bias.hpp"
#include "dapple/device.hpp"
#include "dapple/film.hpp"
#include "dapple/options.hpp"
#include "dapple/shared/ray.h"

namespace dapple {

struct RenderStatistics {
  struct {
    double load = 0, prepare = 0, cache = 0, build = 0, prefilter = 0, refit = 0, upload = 0,
           kernel_build = 0, trace = 0, checkpoint = 0, develop = 0, write = 0, total = 0;
  } seconds;  ///< wall time; the others add up to total. prepare: camera, ground, names, a resumed
              ///< checkpoint; cache: reads and writes; refit: finding and refitting what moved;
              ///< kernel_build: wait for kernels after the scene is on the device; trace: all
              ///< passes, and scenes of later times, without checkpoints; develop: the film
  std::map<std::string, double> pass_seconds;  ///< by pass label, from the device's own clock
  struct {
    std::uint64_t camera = 0, ao = 0, light = 0;
  } rays;
  struct {
    double visits = 0, tests = 0;  ///< node visits and triangle tests a ray
  } camera, ao, light;
  /// With a target: estimated root mean square of the pixels' errors, by pass ("ao", "light.NAME",
  /// of each light of a group); of lights relative to their largest unoccluded irradiance.
  std::map<std::string, double> rmse;
  /// Of prefiltered pictures: the bias by layer of the film, of a group of lights as a whole; also
  /// "ao.back" and the like. Empty if it is not reported.
  std::map<std::string, Bias> bias;
  /// `rmse` together with the bias, where both are known: the estimated distance from the truth.
  std::map<std::string, double> rmse_with_bias;
  /// What errors and biases of lights are relative to: the largest irradiance without occlusion, in
  /// W/m^2 (luminance), by layer of the film. Empty if neither errors nor biases are known.
  std::map<std::string, double> largest_irradiance;
  float footprint = 0;  ///< RenderOptions::footprint, or a smaller one that was chosen
  std::size_t triangles = 0, segments = 0, nodes = 0;
  /// The BVH cache. Small objects are always built and count in neither number.
  struct {
    bool used = false;
    std::size_t objects_read = 0, objects_written = 0;
    double seconds_saved = 0;  ///< build time of the objects that were read, less the read time
  } cache;
  /// For a Renderer's second render and later ones: what it did with the BVHs that it kept.
  struct {
    bool used = false;
    std::size_t objects_kept = 0, objects_refitted = 0, objects_rebuilt = 0;
    double cost_ratio = 1;  ///< BvhUpdate::cost_ratio
  } refit;
  struct {
    std::size_t nodes = 0, triangles = 0, segments = 0, textures = 0, instances = 0, film = 0,
                queues = 0;
  } bytes;             ///< device memory by part
  double ambient = 0;  ///< RenderOptions::ambient as it was used
  std::string device;
  std::string estimator;
  std::vector<std::string> notes;  ///< for the user, such as "no camera in the scene: added one"
};

struct RenderResult {
  Film film;
  RenderStatistics statistics;
  /// The render was stopped early: the film has the samples that were traced by then, and its layer
  /// `samples` counts them. Pixels without samples look like pixels whose rays miss.
  bool interrupted = false;
  /// Why the last checkpoint could not be written, or empty. The checkpoint before it is kept.
  std::string checkpoint_failure;
};

/// A function that is called repeatedly with the fraction done, [0,1].
using Progress = std::function<void(double)>;

/// A function that is called before each slice, which takes a fraction of a second. If it returns
/// true, the render ends.
using Stop = std::function<bool()>;

/// Progress, interruption and checkpoints of a render. They do not change the finished picture.
struct RenderControl {
  Progress progress = {};
  Stop stop = {};
  /// File for the samples that were traced so far, from which `resume` continues. It is written
  /// every `checkpoint_every` seconds and at the end, whole or not at all. Empty: no file.
  std::string checkpoint = {};
  double checkpoint_every = 60;
  /// Checkpoint to continue from. Scene and options must be those of the first run, but there may
  /// be more samples or other targets. Empty: start from the beginning.
  std::string resume = {};
  /// File for the samples that were traced, as the checkpoint has them, written once all are; not
  /// if the render is interrupted. `dapple merge` adds such files up. Empty: no file.
  std::string part = {};
  /// Further settings for the film's metadata.
  std::vector<std::pair<std::string, std::string>> settings = {};
  /// Asked once when `stop` ended a render whose checkpoint is written. true: the film is left
  /// without planes, so that the caller ends sooner.
  std::function<bool()> skip_film = {};
  /// Called with the reason when a checkpoint cannot be written while the work goes on: once, and
  /// again after one could be written.
  std::function<void(const std::string&)> warn = {};
};

/// Renders pictures one after the other, for example of a scene that moves. Keeps the device, its
/// kernels and the scene's BVH from one picture to the next, so that only what moved is refitted
/// and uploaded. Objects are rebuilt when they first move (UpdatableBvh::Motion::maybe).
class Renderer {
 public:
  Renderer();
  /// Uses `device` and its kernels for pictures whose options name it as it was opened. Nothing
  /// else may use that device, or a copy of it, while render() runs, or between prepare() and the
  /// end of the next render().
  explicit Renderer(const Device& device);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Opens the device and begins to load the kernels that pictures with these options probably
  /// need, on another thread, while the caller reads a scene. Errors are left to render().
  void prepare(const RenderOptions& options);

  /// Renders `scene` with `options`: applies overrides, ground, lights and camera; builds or refits
  /// the BVH, uploads it and traces. Throws Error usage, input, device or failed; after an Error
  /// nothing is kept.
  RenderResult render(Scene scene, RenderOptions options, const RenderControl& control = {});

  /// Motion blur: the mean of the pictures at `times` moments of an open shutter, each with an
  /// equal part of `options.spp`, at least one. `scene_at(k)`, k in [0, times), returns the scene
  /// at the k-th moment; it is called twice for each, once if `times` is 1. All scenes have the
  /// same meshes, instances and lights, in other poses. They include their ground (`options.ground`
  /// is refused); the metadata are those of the first. `next_at(k)`: the scene one frame after
  /// scene_at(k), for motion vectors. Throws as render(), and Error usage for targets and
  /// checkpoints.
  RenderResult render_shutter(const std::function<Scene(int)>& scene_at, int times,
                              RenderOptions options, const RenderControl& control = {},
                              const std::function<Scene(int)>& next_at = {});

 private:
  struct Kept;
  std::unique_ptr<Kept> kept_;
};

/// The same with a Renderer that is used once.
RenderResult render(Scene scene, const RenderOptions& options, const RenderControl& control = {});

/// Whether a device can run dapple. check_device() compiles every kernel to find out.
struct DeviceCheck {
  std::vector<std::string> refusals;     ///< one line for each kernel that cannot run
  Packets packets = Packets::automatic;  ///< of a picture's occlusion rays; never automatic
};
DeviceCheck check_device(const Device& device);

struct OcclusionOptions {
  int rays = 64;  ///< for each point, [1, 2^20]
  Estimator estimator = Estimator::prefiltered;
  float footprint = kOcclusionFootprint;  ///< [0, 10^6]
  float distance = 0.0f;                  ///< metres, [0, 10^30]; 0: no limit
  float falloff = 0.0f;                   ///< [0, 100]; above 0 only with a distance
  std::uint32_t seed = 0;
};

/// Returns the ambient occlusion at points, for baking: [0,1], 1 = unoccluded. `normals` are unit
/// vectors. Rays start off the points along the normals, by more than the rounding error of the
/// coordinates. Uses only progress and stop of `control`. Throws Error usage if the sizes differ,
/// a point is not finite, the length of a normal is not 1 within 0.001, or an option is out of
/// range; failed if `stop` returned true.
std::vector<float> occlusion(const Device& device, const DeviceScene& scene,
                             std::span<const V3f> points, std::span<const V3f> normals,
                             const OcclusionOptions& options = {},
                             const RenderControl& control = {});

struct IrradianceOptions {
  int rays = 16;  ///< for each point and light, [1, 2^20]
  Estimator estimator = Estimator::prefiltered;
  float footprint = kDefaultFootprint;  ///< [0, 10^6]
  std::uint32_t seed = 0;
};

/// Irradiance of one light at points, linear RGB, W/m^2.
struct PointIrradiance {
  std::vector<V3f> irradiance;  ///< with occlusion
  std::vector<V3f> unoccluded;  ///< the same without; 0 below the horizon of a point
};

/// Returns the irradiance that each of `lights` causes at points, as the renderer's light layers
/// have it. `lights` are the lights of the scene that was uploaded, after finalize_domes(). Points
/// and normals as for occlusion(). Calls with different seeds are independent of each other; their
/// differences tell the standard error. Uses `control` and throws as occlusion() does.
std::vector<PointIrradiance> irradiance(const Device& device, const DeviceScene& scene,
                                        std::span<const Light> lights, std::span<const V3f> points,
                                        std::span<const V3f> normals,
                                        const IrradianceOptions& options = {},
                                        const RenderControl& control = {});

/// Returns the transmittance along each ray, of which it reads all but `weight`. Begin with `Ray
/// ray{}`; exact rays need an origin, a unit direction and t_max, prefiltered ones also first_area
/// and solid_angle, and a `key` of random bits. The prefiltered estimator with `footprint` 0 is
/// exact. Every `rays_per_point` consecutive rays must have one origin and one light; they may be
/// traced as point packets. Throws Error usage if they differ.
std::vector<Occlusion> trace(const Device& device, const DeviceScene& scene,
                             std::span<const Ray> rays, Estimator estimator,
                             float footprint = kDefaultFootprint, std::size_t rays_per_point = 1);

/// Returns the surface that stops each ray. A surface of opacity a stops a ray with probability a.
/// The random numbers are hashed from origin, direction and key (kernels/camera/closest_hit.cl), so
/// that equal rays have equal results. t < 0: no surface stops the ray.
std::vector<SurfacePoint> closest_hits(const Device& device, const DeviceScene& scene,
                                       std::span<const Ray> rays);

}  // namespace dapple
