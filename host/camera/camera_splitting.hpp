// Camera splitting: how many samples share a camera ray (Arvo and Kirk, "Particle Transport and
// Image Synthesis", 1990). A ray through thin leaves is traced once and shaded at several of its
// surfaces, each chosen by a threshold of its own. In: options and scene; out: the splitting
// factor.
#pragma once

#include <cstdint>

#include "camera/view.hpp"
#include "dapple/options.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// `options.camera_splitting`, or where that is 0 what suits the scene's opacities: those of
/// textures as the view's camera rays average them.
int choose_camera_splitting(const RenderOptions& options, const Scene& scene, const View& view);

/// The options as tracing uses them: `spp` and `max_spp` count samples, of which each camera ray
/// has `camera_splitting` (which must not be 0), and `ao_rays` counts those of one sample.
/// Footprints are those without splitting.
RenderOptions by_sample(const RenderOptions& options);

/// Samples of a camera ray, of options by_sample(); of others 1.
inline std::uint32_t depth_count(const RenderOptions& options) {
  return options.camera_splitting > 0 ? static_cast<std::uint32_t>(options.camera_splitting) : 1u;
}

}  // namespace dapple
