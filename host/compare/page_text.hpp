// The constant parts of the comparison page: its style sheet (CSS) and its script (JavaScript).
// page.cpp puts them into each page.
#pragma once

namespace dapple {

extern const char* const kPageStyle;
extern const char* const kPageScript;

}  // namespace dapple
