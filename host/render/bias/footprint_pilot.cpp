#include "render/bias/footprint_pilot.hpp"

#include <algorithm>

#include "camera/camera_splitting.hpp"
#include "render/bias/bias_pilot.hpp"

namespace dapple {
namespace {

/// Part of the camera rays that a choice may trace for which the user did not ask.
constexpr double kPilotShare = 1.0 / 32;

}  // namespace

bool needs_footprint_pilot(const RenderOptions& options, bool resumed) {
  return (has_bias(options) && (limits_bias(options) || is_adaptive(options))) ||
         (chooses_footprint(options) && !resumed);
}

FootprintChoice footprint_pilot(const KeptScene& kept, const PilotPicture& picture,
                                std::optional<float> first_footprint) {
  RenderOptions sampled = by_sample(picture.options);
  if (first_footprint) sampled.footprint = *first_footprint;
  const bool unasked = chooses_footprint(picture.options);
  View view = picture.view;
  if (unasked) view.crop = {0, 0, view.width - 1, view.height - 1};
  const DeviceBuffers& scene = *kept.on_device.buffers;
  const FilmLayout layout(view.crop, sampled,
                          film_scales(view, picture.bounds, scene.light_records), picture.lights,
                          !scene.corner_normals.empty());
  CameraParams camera = camera_params(view, sampled, scene.bounds);
  if (sampled.cryptomattes.any() || sampled.motion || sampled.deep) camera.medium_error = 0;
  BiasPilot pilot(kept.device->context(), scene, view, sampled, layout, camera);
  FootprintDemand demand{picture.options.footprint, sampled.max_bias.value_or(0),
                         std::max(sampled.target_error, sampled.target_rmse),
                         !first_footprint && !sampled.keep_footprint};
  if (unasked) {
    pilot.limit(kPilotShare);
    demand.max_bias = kDefaultMaxBias;
    demand.only_if_clear = true;
  }
  if (first_footprint && demand.target > 0 &&
      (*first_footprint != demand.footprint || demand.max_bias > 0)) {
    // The rays of the first choice, so that the target leaves as much for the noise.
    FootprintDemand first = demand;
    first.footprint = *first_footprint;
    first.may_shrink = !sampled.keep_footprint;
    FootprintChoice choice = choose_footprint(pilot, first);
    choice.note.clear();
    if (choice.footprint == demand.footprint) return choice;
  }
  return choose_footprint(pilot, demand);
}

}  // namespace dapple
