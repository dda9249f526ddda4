// Refits an object after its vertices moved. In: its arrays and the moved mesh. Out: the same tree
// with new triangles, boxes and opacities.
#pragma once

#include "bvh/opacity/prefilter.hpp"

namespace dapple {

/// Rewrites the object's nodes and blocks for `mesh`, which differs from the built one only in
/// positions, and updates `summary`. In parallel; the bits do not depend on the number of threads.
/// Exact boxes hold the triangles as those of a fresh build do; opacities of subtrees that moved
/// nearly rigidly are taken from the record, all others prefiltered anew.
void refit_object(const Scene& scene, const Mesh& mesh, const ObjectArrays& object,
                  RefitRecord& record, ObjectSummary& summary);

}  // namespace dapple
