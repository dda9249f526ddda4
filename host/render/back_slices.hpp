// The points whose backs are traced, of one slice or of several that follow each other: few points
// of a slice are chosen, and passes of few points take longer for each. In: the surface points of
// slices. Out: queues of points with flipped normals, without gaps, for the passes that trace a
// slice.
#pragma once

#include <span>

#include "dapple/shared/pass_params.h"
#include "passes/back_pass.hpp"

namespace dapple {

class BackSlices {
 public:
  /// `front`: the queues of slices, of `slice_samples` samples at most. The backs share all of them
  /// but points and hits. `choice`: without slice.
  BackSlices(DeviceContext& context, const Queues& front, std::uint32_t slice_samples,
             const BackParams& choice);

  /// Whether add() may add the slice to the pending ones; true if there are none. `work`: of its
  /// group.
  [[nodiscard]] bool fits(const SliceParams& slice, std::span<const PixelWork> work) const;
  /// Comes before shading_pass().
  void add(const SliceParams& slice, std::span<const PixelWork> work);

  [[nodiscard]] bool empty() const { return choice_.resolve.slice.pixel_count == 0; }
  /// Of the pending slices, as if they were one.
  [[nodiscard]] const BackParams& choice() const { return choice_; }
  [[nodiscard]] std::span<const PixelWork> work() const { return work_; }
  [[nodiscard]] const Queues& queues() const { return queues_; }
  void clear() { choice_.resolve.slice.pixel_count = 0; }

  /// Bytes of device memory beside the queues of the front.
  [[nodiscard]] std::size_t bytes() const;

 private:
  DeviceContext& context_;
  const Queues& front_;
  Queues queues_;
  std::uint32_t slice_samples_;
  BackParams choice_;
  std::span<const PixelWork> work_;
};

}  // namespace dapple
