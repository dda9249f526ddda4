// Removes an extension from a glTF document. In: its JSON. Out: the JSON, whose lists name the
// extensions that an element still has.
#pragma once

#include "scene/gltf/edit/source_content.hpp"

namespace dapple::gltf {

/// Whether a primitive, a node or another element has the extension.
bool has_extension(const Json& element, const char* name);

/// Removes the extension from a primitive or node. Returns whether it had it.
bool remove_extension(Json& element, const char* name);

/// Removes an extension that no element has from extensionsUsed and extensionsRequired.
void unlist_unused_extension(Json& json, const char* name);

}  // namespace dapple::gltf
