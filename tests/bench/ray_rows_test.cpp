// Which rows of rays are said to trace something else than exact rays do.
#include "rivals/protocols/ray_rows.hpp"

#include <gtest/gtest.h>

namespace dapple::bench {
namespace {

RayRow row(const std::string& name, double transmittance, bool is_embree = false) {
  RayRow row;
  row.name = name;
  row.is_embree = is_embree;
  row.mean_transmittance = transmittance;
  return row;
}

TEST(RayRows, OnlyRowsThatShouldAgreeWithExactAndDoNotAreNamed) {
  const std::string text = disagreements({row("packets", 0.5, true), row("stochastic", 0.407, true),
                                          row("multiplied", 0.405, true), row("exact", 0.4),
                                          row("exact packets", 0.38), row("prefiltered", 0.45)});
  EXPECT_EQ(text,
            "warning: packets does not agree with exact: transmittance 0.5000, not 0.4000\n"
            "warning: stochastic does not agree with exact: transmittance 0.4070, not 0.4000\n"
            "warning: exact packets does not agree with exact: transmittance 0.3800, not 0.4000\n");
}

TEST(RayRows, WithoutExactRaysThereIsNothingToAgreeWith) {
  EXPECT_EQ(disagreements({row("packets", 0.5, true), row("multiplied", 0.4, true)}), "");
}

TEST(RayRows, TheBestOfEmbreeIsNoneOfOurs) {
  std::vector<RayRow> rows{row("packets", 0, true), row("single", 0, true), row("exact", 0)};
  rows[0].rays_a_second = 2e6;
  rows[1].rays_a_second = 3e6;
  rows[2].rays_a_second = 9e6;
  EXPECT_EQ(best_embree_rate(rows), 3e6);
  EXPECT_EQ(best_embree_rate({rows[2]}), 0);
}

}  // namespace
}  // namespace dapple::bench
