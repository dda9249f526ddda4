// An opened device as a value: copies share it, and a device that was moved from still has it.
#include "dapple/device.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace dapple {
namespace {

TEST(Device, IsStillOpenWhenItWasMovedFrom) {
  Device device;
  const Device moved(std::move(device));
  EXPECT_EQ(device.info().name, moved.info().name);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(&device.context(), &moved.context());
}

}  // namespace
}  // namespace dapple
