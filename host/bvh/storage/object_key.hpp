// The name under which a mesh's BVH is cached: a checksum of everything that the BVH depends on,
// except the builder.
#pragma once

#include "dapple/scene.hpp"
#include "files/checksum.hpp"

namespace dapple {

/// Checksum of the mesh's geometry, its materials' opacities and their textures. Names, instances,
/// lights and other meshes do not count.
Checksum object_key(const Scene& scene, const Mesh& mesh);

/// The same without the positions of vertices, which position_key() covers.
Checksum form_key(const Scene& scene, const Mesh& mesh);
Checksum position_key(const Mesh& mesh);

}  // namespace dapple
