// Compaction lists the samples that hit in ascending order, with one work-group and with hundreds.
#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "passes/camera_pass.hpp"

namespace dapple {
namespace {

TEST(Compact, ListsEveryHitInOrderWithAnyNumberOfWorkGroups) {
  for (const Packets packets : {Packets::none, Packets::scalar}) {
    DeviceContext context("", "", packets);
    // More records than 256 groups of 256 have, and a single one.
    for (const std::size_t samples : {std::size_t{1'300'000}, std::size_t{5}}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(packets) << ", " << samples);
      const Queues queues = make_queues(context, samples, 1);
      std::vector<SampleHits> records(hit_records(samples));
      std::vector<uint> expected;
      std::uint32_t bits = 1;
      for (std::size_t r = 0; r < records.size(); ++r) {
        bits = bits * 1664525u + 1013904223u;
        records[r] = {bits >> 16 & bits >> 9 & 0xffffu, 0, 0, 0};
        for (uint left = records[r].hits; left; left &= left - 1)
          expected.push_back(static_cast<uint>(r * DAPPLE_HIT_BITS) +
                             static_cast<uint>(std::countr_zero(left)));
      }
      context.write(queues.sample_hits, records.data(), records.size() * sizeof(SampleHits));
      ASSERT_EQ(compact_pass(context, queues, samples), expected.size());
      std::vector<uint> active(expected.size());
      context.read(queues.active, active.data(), active.size() * sizeof(uint));
      EXPECT_EQ(active, expected);
      context.read(queues.sample_hits, records.data(), records.size() * sizeof(SampleHits));
      uint slot = 0;
      for (const SampleHits& record : records) {
        EXPECT_EQ(record.first_slot, slot);
        slot += static_cast<uint>(std::popcount(record.hits));
      }
    }
  }
}

}  // namespace
}  // namespace dapple
