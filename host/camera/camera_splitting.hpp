// How many samples share a camera ray, each stopped by a threshold of its own: what a ray through
// thin leaves passes is found once, and shaded at several of its surfaces.
#pragma once

#include <cstdint>

#include "camera/view.hpp"
#include "dapple/options.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// `options.camera_splitting`, or where that is 0 what suits the scene's opacities: those of
/// textures as the view's camera rays average them.
int choose_camera_splitting(const RenderOptions& options, const Scene& scene, const View& view);

/// What tracing takes: `spp` and `max_spp` count samples, of which each camera ray has `depths`,
/// which must be chosen, and `ao_rays` those of one sample. Footprints stay what they are without
/// depths.
RenderOptions by_sample(const RenderOptions& options);

/// Samples of a camera ray, of options by_sample(); of others 1.
inline std::uint32_t depth_count(const RenderOptions& options) {
  return options.camera_splitting > 0 ? static_cast<std::uint32_t>(options.camera_splitting) : 1u;
}

}  // namespace dapple
