// What is wrong with JSON text beyond its grammar, found without building a tree: depth, which
// trees cannot have, and keys twice in one object, of which readers differ in the one they take.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace dapple {

/// "nests deeper than 16 levels" or "has the key "a" twice in one object"; empty when neither,
/// and where the text is not JSON, which its parser will say better.
std::string json_structure_defect(std::string_view text, std::size_t max_depth);

}  // namespace dapple
