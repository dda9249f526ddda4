// Launches with tickets: each ticket is taken exactly once in each launch.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "support/test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

std::vector<uint> times_taken(DeviceContext& context, uint ticket_count, std::size_t group) {
  const Buffer taken = context.allocate_zeros(ticket_count * sizeof(uint));
  context.launch_with_tickets({"take_tickets", "tickets", {}}, "tickets", ticket_count, {taken},
                              group);
  std::vector<uint> times(ticket_count);
  context.read(taken, times.data(), ticket_count * sizeof(uint));
  return times;
}

TEST(Tickets, EveryTicketIsTakenOnce) {
  for (const std::size_t group : {1u, 16u}) {
    for (const uint ticket_count : {1u, 2u, 15u, 16u, 17u, 100u, 5000u})
      EXPECT_EQ(times_taken(device(), ticket_count, group), std::vector<uint>(ticket_count, 1u))
          << ticket_count;
  }
}

/// Tickets are counted modulo 2^32, beginning at 2^32 - 4096, so the counter overflows here.
TEST(Tickets, CountingOverflowsCorrectly) {
  DeviceContext context("", DAPPLE_TEST_KERNELS);
  for (int launch = 0; launch < 20; ++launch)
    EXPECT_EQ(times_taken(context, 1000, 1), std::vector<uint>(1000, 1u)) << launch;
}

TEST(Tickets, NothingIsLaunchedWithoutTickets) {
  DeviceContext context("", DAPPLE_TEST_KERNELS);
  const Buffer taken = context.allocate_zeros(sizeof(uint));
  context.launch_with_tickets({"take_tickets", "tickets", {}}, "nothing", 0, {taken}, 1);
  context.finish();
  EXPECT_FALSE(context.pass_seconds().contains("nothing"));
}

}  // namespace
}  // namespace dapple
