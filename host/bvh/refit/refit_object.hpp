// Refits an object after its vertices moved. In: its arrays, its refit record and the moved mesh.
// Out: the same BVH with new triangles, boxes and opacities.
#pragma once

#include <functional>

#include "bvh/opacity/prefilter.hpp"

namespace dapple {

/// Rewrites the nodes and blocks of the object for `mesh` and updates `summary`. `mesh` may differ
/// from the mesh of the build only in its positions. Runs in parallel; the bits of the result do
/// not depend on the number of threads. The exact boxes contain the triangles, as after a new
/// build. Opacities of subtrees that moved nearly rigidly come from the record; all other opacities
/// are prefiltered again. `textures`: of all textured triangles, made when they are needed first.
void refit_object(const Mesh& mesh, const ObjectArrays& object,
                  const std::function<const TextureIntegrals&()>& textures, RefitRecord& record,
                  ObjectSummary& summary);

}  // namespace dapple
