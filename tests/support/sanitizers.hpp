// Whether the tests and the program run with a sanitizer, which maps terabytes of address space,
// keeps freed memory for a while, and needs larger stacks and /proc.
#pragma once

#include <gtest/gtest.h>

namespace dapple {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

#ifdef __SANITIZE_THREAD__
inline constexpr bool kThreadSanitized = true;
#else
inline constexpr bool kThreadSanitized = false;
#endif

}  // namespace dapple

/// For tests of limits: ends them with a message.
#define DAPPLE_SKIP_WITH_SANITIZER() \
  if (dapple::kSanitized) GTEST_SKIP() << "a sanitizer needs more than this test allows: left out"
