// Means of independent sets of rays and their standard errors, of numbers that are known.
#include "points/set_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace dapple {
namespace {

// The deviations of 0.1, 0.2, 0.3 and 0.6 from their mean are -0.2, -0.1, 0 and 0.3: their squares
// add up to 0.14, and the variance of the mean is 0.14 / (3 * 4).
TEST(SetSums, TheStandardErrorIsThatOfTheMean) {
  SetSums sums(2);
  for (const double value : {0.1, 0.2, 0.3, 0.6})
    sums.add([&](std::size_t i) { return i == 0 ? value : 0.5; });
  std::vector<PointColumn> columns;
  sums.store("ao", BiasCorrection(), columns);
  ASSERT_EQ(columns.size(), 2u);
  EXPECT_EQ(columns[0].name, "ao");
  EXPECT_FLOAT_EQ(columns[0].values.at(0), 0.3f);
  EXPECT_FLOAT_EQ(columns[0].values.at(1), 0.5f);
  EXPECT_EQ(columns[1].name, "ao_error");
  EXPECT_NEAR(columns[1].values.at(0), std::sqrt(0.14 / 12), 1e-6);
  EXPECT_EQ(columns[1].values.at(1), 0.0f);
}

// Rays that are hidden or not, whose values fall by nothing, tell of no bias; those of several do,
// although their mean is the same.
TEST(SetSums, TheCorrectionIsByTheFallsOfTheSetsNotOfTheirMean) {
  const BiasCorrection bias(std::vector{0.4, 0.4}, std::vector{0.5, 0.5});
  SetSums sums(2);
  for (const double value : {0.0, 1.0})
    sums.add([&](std::size_t i) { return i == 0 ? value : 0.5; });
  std::vector<PointColumn> columns;
  sums.store("ao", bias, columns);
  EXPECT_FLOAT_EQ(columns.at(0).values.at(0), 0.5f);
  EXPECT_FLOAT_EQ(columns[0].values.at(1), 0.4f);
}

// The values of the sets are 0.1, 0.2, 0.3 and 0.6 before they are corrected, as above.
TEST(SetSums, TheStandardErrorIsThatOfCorrectedValues) {
  const BiasCorrection bias(std::vector{0.4, 0.4}, std::vector{0.5, 0.5});
  SetSums sums(1), corrected(1);
  for (const double value : {0.1, 0.2, 0.3, 0.6}) {
    sums.add([&](std::size_t) { return value; });
    corrected.add([&](std::size_t) { return value + bias.change(fall_with_depth(value)); });
  }
  std::vector<PointColumn> columns;
  sums.store("ao", bias, columns);
  corrected.store("ao", BiasCorrection(), columns);
  EXPECT_NEAR(columns.at(0).values.at(0), columns.at(2).values.at(0), 1e-6);
  EXPECT_NEAR(columns.at(1).values.at(0), columns.at(3).values.at(0), 1e-6);
}

TEST(SetSums, CorrectedValuesStayBetweenNothingAndTheWhole) {
  const BiasCorrection darker(std::vector{0.0, 0.0}, std::vector{0.5, 0.5});
  const BiasCorrection lighter(std::vector{1.0, 1.0}, std::vector{0.5, 0.5});
  SetSums sums(1);
  for (int set = 0; set < 2; ++set)
    sums.add([](std::size_t) { return 1.2; }, [](std::size_t) { return 4.0; });  // 0.3 of 4
  std::vector<PointColumn> columns;
  const auto whole = [](std::size_t) { return 4.0; };
  sums.store("lamp", darker, whole, columns);
  sums.store("lamp", lighter, whole, columns);
  EXPECT_EQ(columns.at(0).values.at(0), 0.0f);
  EXPECT_GT(columns.at(2).values.at(0), 1.2f);
  EXPECT_LE(columns.at(2).values.at(0), 4.0f);
}

}  // namespace
}  // namespace dapple
