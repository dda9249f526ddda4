// What the host adds up of the hits of camera rays: objects and materials (Cryptomatte), image
// motion, depths. In: hits of a slice, as the camera pass kept them. Out: sums by pixel.
#pragma once

#include <optional>
#include <span>

#include "dapple/shared/pass_params.h"
#include "film/sums/matte_sums.hpp"
#include "render/matte_lookup.hpp"
#include "render/motion_lookup.hpp"
#include "render/trace_state.hpp"

namespace dapple {

/// Which sums a picture needs, and what their hits are looked up in; with any of it there are no
/// media.
struct HitLookups {
  std::optional<MatteLookup> mattes;   ///< count what the samples hit
  std::optional<MotionLookup> motion;  ///< add up how they move until the next frame
  bool deep = false;                   ///< sort them by depth
  [[nodiscard]] bool any() const { return mattes || motion || deep; }
};

class HitSums {
 public:
  /// `lookups` must outlive this. `first_sample`: the number of each pixel's first sample.
  HitSums(const HitLookups& lookups, std::size_t pixels, std::uint32_t first_sample);

  /// Moves the state's sums here, if it has any.
  void take_from(TraceState& state);
  void copy_to(TraceState& state) const;

  /// Adds the samples of a slice, pixel by pixel, each in its order. `work`: of the slice's group;
  /// `points`, `hits`: of its samples, as the camera pass left them; `view`: eye and axis.
  void add(const SliceParams& slice, std::span<const PixelWork> work,
           std::span<const SurfacePoint> points, std::span<const SampleHits> hits,
           const ResolveParams& view);

  MatteSums mattes;
  MotionSums motion;
  DeepSums deep;

 private:
  void add_hit(uint pixel, uint sample, const SurfacePoint& point, const ResolveParams& view);

  const HitLookups& lookups_;
  std::size_t pixels_;
};

}  // namespace dapple
