// A scene with one of everything that glTF has, for the corpus to damage or to twist.
#pragma once

#include "support/gltf_builder.hpp"

namespace dapple::test {

/// A blended, textured card over a ground with sparse positions; a camera, a spot light, a
/// skin, an animation, a morph target. Every property that the schema knows is there once.
GltfBuilder sound_scene();

}  // namespace dapple::test
