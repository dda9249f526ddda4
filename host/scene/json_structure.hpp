// Finds two defects of JSON text that its grammar allows: nesting that is too deep, and a key that
// appears twice in one object (readers differ in which of the two values they take).
// In: text; out: the text of a message. No tree of values is built.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace dapple {

/// Returns "nests deeper than 16 levels" or "has the key "a" twice in one object", whichever comes
/// first. Returns "" when there is neither, also for text that is not JSON: its parser reports
/// that with a better message.
std::string json_structure_defect(std::string_view text, std::size_t max_depth);

}  // namespace dapple
