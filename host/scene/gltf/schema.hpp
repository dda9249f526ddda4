// The glTF 2.0 schema: every property that is there has the right JSON type, the right array
// length and a value that it can have.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace dapple::gltf {

/// Throws Error input naming the element and the property. Integers written as 3.0 are
/// turned into 3. tinygltf drops a property of the wrong type in silence and cuts
/// integers to 32 bits: behind this check it meets neither.
void check_schema(nlohmann::json& root, const std::string& file);

}  // namespace dapple::gltf
