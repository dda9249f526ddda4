// Pictures by Embree: a small renderer as one would write it today. Tiles over threads; within a
// tile batches of camera rays, then AO rays or one ray a light from every point they met.
#pragma once

#include <vector>

#include "rivals/camera_rays.hpp"
#include "rivals/embree_trace.hpp"

namespace dapple::bench {

enum class Pass : std::uint8_t { ao, light };

/// How the two kinds of rays of a picture are traced, and AO rays a camera sample.
struct PictureMethod {
  EmbreeMethod camera, occlusion;
  std::uint32_t ao_rays = 1;
};

class EmbreePictures {
 public:
  /// Throws Error usage when a light cannot be sampled here.
  EmbreePictures(const EmbreeScenes& scenes, const View& view, std::vector<Light> lights);

  [[nodiscard]] const CameraRays& camera() const { return camera_; }

  /// AO pixels row by row (1 where a camera ray meets nothing), or each light's irradiance at
  /// radiance 1, light after light. `spp` samples a pixel.
  [[nodiscard]] std::vector<double> render(Pass pass, int spp, std::uint32_t seed,
                                           const PictureMethod& method, float black) const;

  /// Every pixel's camera rays alone, for choosing how to trace them.
  void trace_camera_rays(int spp, std::uint32_t seed, const EmbreeMethod& method) const;

 private:
  struct Worker;
  template <class Work>
  void for_each_tile(float black, const Work& work) const;

  const EmbreeScenes& scenes_;
  CameraRays camera_;
  std::vector<Light> lights_;
};

}  // namespace dapple::bench
