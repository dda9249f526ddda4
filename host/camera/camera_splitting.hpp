// Camera splitting: how many samples share a camera ray (Arvo and Kirk, "Particle Transport and
// Image Synthesis", 1990). A ray through thin leaves is traced once and shaded at several of its
// surfaces, each chosen by its own threshold. In: options, scene and view. Out: the splitting
// factor, and the options as tracing uses them.
#pragma once

#include <cstdint>

#include "camera/view.hpp"
#include "dapple/options.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// `options.camera_splitting`, or, if that is 0, the factor 1, 2 or 4 that suits the opacities of
/// the scene's surfaces. Textures count with their opacities as the view's camera rays average
/// them.
int choose_camera_splitting(const RenderOptions& options, const Scene& scene, const View& view);

/// The options as tracing uses them. `spp` and `max_spp` count samples instead of camera rays, each
/// of which has `camera_splitting` samples; that must not be 0. `ao_rays` counts the AO rays of one
/// sample. Footprints are as large as without camera splitting.
RenderOptions by_sample(const RenderOptions& options);

/// Number of samples that share a camera ray: `options.camera_splitting`, or 1 if that is 0.
inline std::uint32_t splitting_factor(const RenderOptions& options) {
  return options.camera_splitting > 0 ? static_cast<std::uint32_t>(options.camera_splitting) : 1u;
}

}  // namespace dapple
