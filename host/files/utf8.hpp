// Text of files and their names, which may have any bytes, for files that hold UTF-8. In: bytes.
// Out: UTF-8.
#pragma once

#include <string>

namespace dapple {

/// `bytes` with U+FFFD in place of those that are no UTF-8, as the JSON files have them.
std::string utf8_of(const std::string& bytes);

}  // namespace dapple
