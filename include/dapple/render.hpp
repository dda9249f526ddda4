// The library's two main functions: render() makes a film of a scene, and occlusion() returns AO at
// points, for baking. Also the queries below them, trace() and closest_hits(), for tests and
// benches.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dapple/device.hpp"
#include "dapple/film.hpp"
#include "dapple/options.hpp"
#include "dapple/shared/ray.h"

namespace dapple {

struct RenderStatistics {
  struct {
    double load = 0, cache = 0, build = 0, prefilter = 0, refit = 0, upload = 0, kernel_build = 0,
           trace = 0, checkpoint = 0, write = 0, total = 0;
  } seconds;  ///< wall time; cache is reading and writing it, refit is finding what moved and
              ///< refitting it, kernel_build waiting for kernels once the scene is on the device,
              ///< trace all passes, camera rays included, checkpoints not
  std::map<std::string, double> pass_seconds;  ///< by pass label, from the device's own clock
  struct {
    std::uint64_t camera = 0, ao = 0, light = 0;
  } rays;
  struct {
    double visits = 0, tests = 0;  ///< node visits and triangle tests a ray
  } camera, ao, light;
  /// With a target: estimated root mean square of the pixels' errors, by layer ("ao",
  /// "light.NAME"); of lights relative to their largest unoccluded irradiance.
  std::map<std::string, double> rmse;
  std::size_t triangles = 0, segments = 0, nodes = 0;
  /// Of the cache of BVHs. Small objects are always built and count among neither.
  struct {
    bool used = false;
    std::size_t objects_read = 0, objects_written = 0;
    double seconds_saved = 0;  ///< building what was read once took so much longer than reading it
  } cache;
  /// Of a Renderer's renders after its first: what became of the BVHs that it had.
  struct {
    bool used = false;
    std::size_t objects_kept = 0, objects_refitted = 0, objects_rebuilt = 0;
    double cost_ratio = 1;  ///< BvhUpdate::cost_ratio
  } refit;
  struct {
    std::size_t nodes = 0, triangles = 0, segments = 0, textures = 0, instances = 0, film = 0,
                queues = 0;
  } bytes;  ///< device memory by part
  std::string device;
  std::string estimator;
  std::vector<std::string> notes;  ///< choices made for the user: "no camera: framed the scene"
};

struct RenderResult {
  Film film;
  RenderStatistics statistics;
  /// Stopped early: the film is what there was by then, its layer `samples` says how much. Pixels
  /// without samples are as those whose rays miss.
  bool interrupted = false;
  /// Why the last checkpoint could not be written; empty: it could. The one before it is kept.
  std::string checkpoint_failure;
};

/// Called now and then with the fraction done, [0,1].
using Progress = std::function<void(double)>;

/// Asked before each slice of a fraction of a second; true ends the render.
using Stop = std::function<bool()>;

/// How a long render is watched, interrupted and continued; nothing of it changes the picture.
struct RenderControl {
  Progress progress;
  Stop stop;
  /// File that holds what is traced, for `resume`: written every `checkpoint_every` seconds and at
  /// the end, whole or not at all; empty: none.
  std::string checkpoint;
  double checkpoint_every = 60;
  /// Checkpoint to go on from. Scene and options must be those that it was made with, but for more
  /// samples or other targets. Empty: begin.
  std::string resume;
};

/// Renders pictures one after the other, as of a scene that moves. Keeps the device with its
/// kernels and the scene's BVH from one to the next, so that only what moved is refitted and
/// brought to the device (UpdatableBvh: built once more when things first move).
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Renders `scene` as `options` say: applies overrides, ground, lights and camera, builds or
  /// refits, uploads, traces. Throws Error usage, input, device or failed, and keeps nothing then.
  RenderResult render(Scene scene, RenderOptions options, const RenderControl& control = {});

 private:
  struct Kept;
  std::unique_ptr<Kept> kept_;
};

/// A Renderer used once.
RenderResult render(Scene scene, const RenderOptions& options, const RenderControl& control);
RenderResult render(Scene scene, const RenderOptions& options, const Progress& progress = {});

/// Whether a device can do all that dapple asks of devices, found out by compiling every kernel.
struct DeviceCheck {
  std::vector<std::string> refusals;     ///< a line a kernel that cannot run; empty: none
  Packets packets = Packets::automatic;  ///< of a picture's occlusion rays, never automatic
};
DeviceCheck check_device(const Device& device);

struct OcclusionOptions {
  int rays = 64;  ///< a point, [1, 2^20]
  Estimator estimator = Estimator::prefiltered;
  float footprint = kDefaultFootprint;
  float distance = 0.0f;  ///< metres; 0: no limit
  float falloff = 0.0f;
  std::uint32_t seed = 0;
};

/// Ambient occlusion at points, for baking: 1 = unoccluded. `normals` are unit vectors;
/// origins are offset along them by the rounding error of the coordinates.
/// Throws Error usage when the sizes differ.
std::vector<float> occlusion(const Device& device, const DeviceScene& scene,
                             std::span<const V3f> points, std::span<const V3f> normals,
                             const OcclusionOptions& options = {});

/// Transmittance along each ray. `footprint` 0 with the prefiltered estimator equals exact.
/// Rays that share a point may be traced together: `rays_per_point` of them in a row, with one
/// origin and light. Throws Error usage.
std::vector<Occlusion> trace(const Device& device, const DeviceScene& scene,
                             std::span<const Ray> rays, Estimator estimator,
                             float footprint = kDefaultFootprint, std::size_t rays_per_point = 1);

/// The surface that stops each ray: of the rays that come to a surface of opacity a, the share a.
/// Which these are is hashed from origin, direction and key (kernels/camera/closest_hit.cl): the
/// same ray finds the same. Where t < 0 there is none.
std::vector<SurfacePoint> closest_hits(const Device& device, const DeviceScene& scene,
                                       std::span<const Ray> rays);

}  // namespace dapple
