// Shared by the tests that wait for processes which others have started.
#pragma once

#include <sys/prctl.h>

namespace dapple::program_test {

/// While an object lives, processes below this one whose parent has ended become its children.
class Adoption {
 public:
  Adoption() { prctl(PR_SET_CHILD_SUBREAPER, 1); }
  ~Adoption() { prctl(PR_SET_CHILD_SUBREAPER, 0); }
  Adoption(const Adoption&) = delete;
  Adoption& operator=(const Adoption&) = delete;
};

}  // namespace dapple::program_test
