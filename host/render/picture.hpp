// Traces one picture, slice by slice. In: scene, view and options. Out: film sums. Adaptive
// sampling chooses the pixels of each round.
#pragma once

#include <functional>

#include "dapple/render.hpp"
#include "device/upload/scene_upload.hpp"
#include "film/sums/film_sums.hpp"
#include "film/traced_picture.hpp"
#include "render/hit_sums.hpp"
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
  /// Asked once an interrupted picture is saved. true: it is left without sums, for the end is
  /// near.
  std::function<bool()> skip_film = {};
};

/// Runs every pass that `options` select over the view's crop. The result depends on
/// neither the slices nor the device's threads. Continues from `state`, which must fit the picture,
/// unless it is empty.
TracedPicture trace_picture(const Device& device, const DeviceScene& scene, const View& view,
                            const RenderOptions& options, const FilmLayout& layout,
                            const TraceControl& control, TraceState state = {},
                            const HitLookups& lookups = {});

}  // namespace dapple
