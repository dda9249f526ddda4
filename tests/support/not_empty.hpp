// For loops of expectations over values: such a loop over none would pass.
#pragma once

#include <gtest/gtest.h>

#include <vector>

namespace dapple {

/// Returns `values`, of which there must be some.
template <class Value>
const std::vector<Value>& not_empty(const std::vector<Value>& values) {
  EXPECT_FALSE(values.empty());
  return values;
}

}  // namespace dapple
