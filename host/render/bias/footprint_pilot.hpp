// Chooses the footprint of a picture by the bias that a pilot measures before sampling starts. In:
// the scene on its device and the options. Out: a footprint, and the bias that a target must count.
#pragma once

#include <optional>

#include "film/sums/film_sums.hpp"
#include "render/kept_scene.hpp"
#include "sampling/footprint_choice.hpp"

namespace dapple {

/// What is rendered from the scene that `kept` has on its device. The members must outlive calls.
struct PilotPicture {
  const View& view;
  const RenderOptions& options;
  const Box3f& bounds;  ///< of the scene, world space
  const std::vector<Light>& lights;
};

/// Whether a footprint is chosen, or the bias is needed for a target. `resumed`: the picture has
/// samples, with a footprint.
bool needs_footprint_pilot(const RenderOptions& options, bool resumed);

/// `first_footprint`: of a resumed picture, what its first run began with. The footprint stays. If
/// dapple chooses without a limit or a target being given, it chooses the same for all crops and
/// shards of a picture: the pilot has the whole picture's rays.
FootprintChoice footprint_pilot(const KeptScene& kept, const PilotPicture& picture,
                                std::optional<float> first_footprint);

}  // namespace dapple
