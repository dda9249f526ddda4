// A small renderer that traces with Embree. In: scenes, a view and lights. Out: AO or irradiance of
// each pixel. Threads take tiles. Within a tile it traces batches of camera rays, then AO rays or
// one ray per light from every hit point.
#pragma once

#include <vector>

#include "rivals/embree/camera_rays.hpp"
#include "rivals/embree/embree_trace.hpp"
#include "rivals/embree/light_sampler.hpp"

namespace dapple::bench {

enum class Pass : std::uint8_t { ao, light };

/// How camera rays and occlusion rays are traced, and the number of AO rays per camera sample.
struct PictureMethod {
  EmbreeMethod camera, occlusion;
  std::uint32_t ao_rays = 1;
};

class EmbreePictures {
 public:
  /// Throws Error usage for a light that LightSampler cannot sample.
  EmbreePictures(const EmbreeScenes& scenes, const View& view, const std::vector<Light>& lights);

  [[nodiscard]] const CameraRays& camera() const { return camera_; }

  /// Renders with `spp` samples per pixel. Returns AO, row by row (1 for camera rays without a
  /// hit), or the irradiance of each light at radiance 1, light after light.
  [[nodiscard]] std::vector<double> render(Pass pass, int spp, std::uint32_t seed,
                                           const PictureMethod& method, float black) const;

  /// Traces only the camera rays, to find the fastest method for them.
  void trace_camera_rays(int spp, std::uint32_t seed, const EmbreeMethod& method) const;

 private:
  struct Worker;
  template <class Work>
  void for_each_tile(float black, const Work& work) const;

  const EmbreeScenes& scenes_;
  CameraRays camera_;
  std::vector<LightSampler> lights_;
};

}  // namespace dapple::bench
