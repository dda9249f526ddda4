// The parts of the comparison page that never vary.
#pragma once

namespace dapple {

extern const char* const kPageStyle;
extern const char* const kPageScript;

}  // namespace dapple
