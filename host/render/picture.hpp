// Traces one picture, slice by slice. In: scene, view and options. Out: film sums. Adaptive
// sampling chooses the pixels of each round.
#pragma once

#include <optional>

#include "dapple/render.hpp"
#include "device/upload/scene_upload.hpp"
#include "film/film_sums.hpp"
#include "film/traced_picture.hpp"
#include "render/matte_lookup.hpp"
#include "render/motion_lookup.hpp"
#include "render/trace_state.hpp"
#include "sampling/sample_plan.hpp"

namespace dapple {

/// Progress, interruption and checkpoints of tracing; each function may be empty.
struct TraceControl {
  Progress progress;
  Stop stop;                                      ///< asked before each slice
  std::function<void(const TraceState&)> save;    ///< called every `save_every` and at the end
  double save_every = 0;                          ///< seconds
  std::function<void(const TraceState&)> finish;  ///< called once all samples are traced
  SampleOrder order = SampleOrder::pixels;
};

/// What the host does with the hits of camera rays; with any of it there are no media.
struct HitLookups {
  std::optional<MatteLookup> mattes;   ///< count what the samples hit
  std::optional<MotionLookup> motion;  ///< add up how they move until the next frame
  bool deep = false;                   ///< sort them by depth
  [[nodiscard]] bool any() const { return mattes || motion || deep; }
};

/// Runs every pass that `options` select over the view's crop. The result depends on
/// neither the slices nor the device's threads. Continues from `state`, which must fit the picture,
/// unless it is empty.
TracedPicture trace_picture(const Device& device, const DeviceScene& scene, const View& view,
                            const RenderOptions& options, const FilmLayout& layout,
                            const TraceControl& control, TraceState state = {},
                            const HitLookups& lookups = {});

}  // namespace dapple
