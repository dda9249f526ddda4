// An object's arrays after its vertices moved: triangles, boxes and opacities, over the tree that
// it has.
#pragma once

#include "bvh/opacity/prefilter.hpp"

namespace dapple {

/// Rewrites the object's nodes and blocks for `mesh`, which is what it was built of but for
/// positions, and of `summary` what depends on them. In parallel, the same bits whatever the thread
/// count. Exact boxes hold the triangles as those of a fresh build do; opacities of subtrees that
/// moved nearly rigidly are taken from the record, all others prefiltered anew.
void refit_object(const Scene& scene, const Mesh& mesh, const ObjectArrays& object,
                  RefitRecord& record, ObjectSummary& summary);

}  // namespace dapple
