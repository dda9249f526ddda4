// The samples whose other side is traced for `--passes back`. In: the surface points of a slice.
// Out: queues of turned points.
#pragma once

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple {

inline const KernelName kTurnPoints{"turn_points", "queue_kernels", {}};
inline const KernelName kCountBacks{"count_backs", "queue_kernels", {}};

/// Writes the points of the chosen samples of a slice, turned to the side that is not seen, to
/// backs.points, and which of them hit to backs.sample_hits; adds their numbers to two planes of
/// the film. Comes before shading_pass().
void turn_points_pass(DeviceContext& context, const Queues& queues, const Queues& backs,
                      const FilmBuffers& film, const BackParams& params);

}  // namespace dapple
