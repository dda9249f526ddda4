// Rows of coverage maps: registers of 4, 8 and 16 floats, where the processor has them, give the
// same bits, those of a loop over the cells.
#include "bvh/opacity/map_row.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace dapple {
namespace {

using Cells = std::array<float, kMapSize>;

struct Results {
  Cells shares, at_least, one_hot;
  float sum, max;
  bool operator==(const Results&) const = default;
};

// Two rows with values on both sides of 0 and 1, and exactly on them.
Cells first_row() {
  Cells cells;
  for (int i = 0; i < kMapSize; ++i) cells[i] = std::sin(2.7f * static_cast<float>(i)) * 1.3f;
  cells[5] = 1.0f;
  cells[11] = 0.0f;
  return cells;
}
Cells second_row() {
  Cells cells;
  for (int i = 0; i < kMapSize; ++i) cells[i] = std::cos(1.9f * static_cast<float>(i)) + 1.1f;
  return cells;
}

template <int kLanes>
DAPPLE_ALWAYS_INLINE Results results_in_registers(const Cells& a, const Cells& b) {
  Results out;
  const auto x = Row<kLanes>::load(a.data()), y = Row<kLanes>::load(b.data());
  const auto shares = max(min((x + Row<kLanes>::indices()) * y / (y + 0.5f) - x, 9.0f), 0.0f);
  shares.store(out.shares.data());
  at_least(x, 1.0f).store(out.at_least.data());
  const auto columns = Row<kLanes>::indices();
  (where_equal(columns, 3.0f, 0.5f) + where_equal(columns, kMapSize, 0.25f))
      .store(out.one_hot.data());
  out.sum = shares.sum();
  out.max = shares.max();
  return out;
}

Results results_by_cell(const Cells& a, const Cells& b) {
  Results out;
  for (int i = 0; i < kMapSize; ++i) {
    const float share = (a[i] + static_cast<float>(i)) * b[i] / (b[i] + 0.5f) - a[i];
    out.shares[i] = std::max(std::min(share, 9.0f), 0.0f);
    out.at_least[i] = a[i] >= 1.0f ? 1.0f : 0.0f;
    out.one_hot[i] = i == 3 ? 0.5f : 0.0f;
  }
  out.max = *std::max_element(out.shares.begin(), out.shares.end());
  Cells sum = out.shares;
  for (int half = kMapSize / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) sum[i] += sum[i + half];
  }
  out.sum = sum[0];
  return out;
}

TEST(MapRow, AllRegisterWidthsGiveTheBitsOfALoop) {
  const Cells a = first_row(), b = second_row();
  const Results expected = results_by_cell(a, b);
  std::vector<Results> found{results_in_registers<4>(a, b)};
  Results wide;
  const auto body = [&]<int kLanes>() __attribute__((always_inline)) {
    wide = results_in_registers<kLanes>(a, b);
  };
  for_register_width(body);
  found.push_back(wide);
#ifdef DAPPLE_TARGET
  if (kFloatsPerRegister >= 8) {
    run_with_8_floats(body);
    found.push_back(wide);
  }
#endif
  for (const Results& result : found) EXPECT_EQ(result, expected);
}

}  // namespace
}  // namespace dapple
