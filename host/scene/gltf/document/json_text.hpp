// Parses JSON text to a tree of values. Depth and number of values are limited before parsing,
// because parsers recurse and a tree takes many times the memory of its text.
// In: text; out: a nlohmann::json value.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace dapple::gltf {

/// Throws Error input when the text is not JSON, has a key twice in one object, or exceeds the
/// limits of size and depth.
nlohmann::json parse_json(std::string_view text, const std::string& file);

}  // namespace dapple::gltf
