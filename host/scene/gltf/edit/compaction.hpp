// Drops what edits of a glTF document left without use, so that a file that is baked again does not
// grow. In: the document before and after the edits, which only added elements, and its binary.
// Out: both without accessors, bufferViews, textures, samplers and images that lost their last use.
#pragma once

#include <string>

#include "scene/gltf/edit/source_content.hpp"

namespace dapple::gltf {

/// Elements that the document had before the edits keep their index: new ones move into the places
/// of those that are dropped; where there are none, an unused element before a used one stays. So
/// does what was without use before. Does nothing when the document uses an extension that may
/// refer to elements in a way that dapple does not know.
void drop_unused(const Json& before, Json& after, std::string& binary);

}  // namespace dapple::gltf
