// The samples whose other side is traced for `--passes back`. In: the surface points of a slice.
// Out: queues of points with flipped normals.
#pragma once

#include <span>

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple {

inline const KernelName kFlipPoints{"flip_points", "queue_kernels", {}};
inline const KernelName kCountBacks{"count_backs", "queue_kernels", {}};

/// BackParams::slots for a slice: how many groups the samples of a pixel are in at most. `work`: of
/// the slice's group.
uint groups_touched(const SliceParams& slice, std::span<const PixelWork> work, uint group_bits);

/// The slice of the chosen samples of choice.resolve.slice alone, so that later passes find them
/// without gaps: one sample for each group that a pixel's samples belong to.
SliceParams packed_slice(const BackParams& choice);

/// Writes the points of the chosen samples, flipped to the side that is not seen, to backs.points,
/// and which of them hit to backs.sample_hits: packed_slice(), from choice.first_packed on. Comes
/// before shading_pass().
void flip_points_pass(DeviceContext& context, const Queues& queues, const Queues& backs,
                      const BackParams& choice);

/// Adds the numbers of chosen samples and of those that hit to two planes of the film.
void count_backs_pass(DeviceContext& context, const Queues& backs, const FilmBuffers& film,
                      const BackParams& choice);

}  // namespace dapple
