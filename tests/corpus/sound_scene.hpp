// A valid scene that uses each kind of glTF element. The corpus makes malformed cases from it.
#pragma once

#include "support/files/gltf_builder.hpp"

namespace dapple::test {

/// A blended, textured card over a ground with sparse positions; two cameras, a spot light, a skin,
/// an animation, a morph target. Each property that the schema knows occurs at least once.
GltfBuilder sound_scene();

}  // namespace dapple::test
