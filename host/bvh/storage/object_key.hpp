// The name under which a mesh's tree is cached: a checksum of everything that the tree is a
// function of, but of what builds it.
#pragma once

#include "dapple/scene.hpp"
#include "files/checksum.hpp"

namespace dapple {

/// Of the mesh's geometry, its materials' opacities and their textures. Names, instances, lights
/// and whatever other meshes use make no difference.
Checksum object_key(const Scene& scene, const Mesh& mesh);

/// Of all that but where the vertices are, which position_key() tells.
Checksum form_key(const Scene& scene, const Mesh& mesh);
Checksum position_key(const Mesh& mesh);

}  // namespace dapple
