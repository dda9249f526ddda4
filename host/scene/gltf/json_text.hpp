// From JSON text to a tree. How deep it nests and how much it holds is counted before it is
// parsed, since parsers recurse and their trees take many times the text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace dapple::gltf {

/// Throws Error input when the text is not JSON, has a key twice in one object, or is larger or
/// deeper than any scene is.
nlohmann::json parse_json(std::string_view text, const std::string& file);

}  // namespace dapple::gltf
