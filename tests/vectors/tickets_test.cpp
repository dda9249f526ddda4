// Work that is taken by turns: each piece once, whoever takes it, launch after launch.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "support/test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

std::vector<uint> times_taken(DeviceContext& context, uint pieces, std::size_t group) {
  const Buffer taken = context.allocate_zeros(pieces * sizeof(uint));
  context.launch_in_turns({"take_pieces", "tickets", {}}, "turns", pieces, {taken}, group);
  std::vector<uint> times(pieces);
  context.read(taken, times.data(), pieces * sizeof(uint));
  return times;
}

TEST(Turns, EveryPieceIsTakenOnce) {
  for (const std::size_t group : {1u, 16u}) {
    for (const uint pieces : {1u, 2u, 15u, 16u, 17u, 100u, 5000u})
      EXPECT_EQ(times_taken(device(), pieces, group), std::vector<uint>(pieces, 1u)) << pieces;
  }
}

/// Turns are counted from 4096 below 2^32 on.
TEST(Turns, CountingStartsAgain) {
  DeviceContext context("", DAPPLE_TEST_KERNELS);
  for (int launch = 0; launch < 20; ++launch)
    EXPECT_EQ(times_taken(context, 1000, 1), std::vector<uint>(1000, 1u)) << launch;
}

TEST(Turns, NothingIsLaunchedForNoPieces) {
  DeviceContext context("", DAPPLE_TEST_KERNELS);
  const Buffer taken = context.allocate_zeros(sizeof(uint));
  context.launch_in_turns({"take_pieces", "tickets", {}}, "nothing", 0, {taken}, 1);
  context.finish();
  EXPECT_FALSE(context.pass_seconds().contains("nothing"));
}

}  // namespace
}  // namespace dapple
