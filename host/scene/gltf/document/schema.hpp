// Checks a document against the glTF 2.0 schema: every property must have the right JSON type, the
// right array length and an allowed value. In: a JSON tree; out: the same tree with normalized
// numbers, or an error.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace dapple::gltf {

/// Throws Error input naming the element and the property. Integers that are written as 3.0 become
/// 3; `extras` are removed. Without this check, tinygltf would silently drop a property of the
/// wrong type and would truncate integers to 32 bits.
void check_schema(nlohmann::json& root, const std::string& file);

}  // namespace dapple::gltf
