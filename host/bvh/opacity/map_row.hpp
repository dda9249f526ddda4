// A row of a coverage map in one to four vector registers. In: the row in memory, or two rows. Out:
// the row as a vector, stored again, or its minimum with another; its sum or maximum.
#pragma once

#include <cstring>

#include "bvh/opacity/coverage_map.hpp"

namespace dapple {

using Row = float __attribute__((vector_size(kMapSize * sizeof(float))));

// By reference: vectors wider than the registers of the instruction set have no calling convention.
inline void load_row(const float* from, Row& row) { std::memcpy(&row, from, sizeof row); }
inline void store_row(float* to, const Row& row) { std::memcpy(to, &row, sizeof row); }

inline void keep_min(Row& row, const Row& other) { row = row < other ? row : other; }

/// Adds one half of the vector to the other, repeatedly: a chain of four additions, not sixteen.
inline float sum_of(const Row& row) {
  Row sum = row;
  sum += __builtin_shufflevector(sum, sum, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7);
  sum += __builtin_shufflevector(sum, sum, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11);
  sum += __builtin_shufflevector(sum, sum, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13);
  return sum[0] + sum[1];
}

inline float max_of(const Row& row) {
  Row max = row;
  const auto take = [&max](const Row& other) { max = max > other ? max : other; };
  take(__builtin_shufflevector(max, max, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7));
  take(__builtin_shufflevector(max, max, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11));
  take(__builtin_shufflevector(max, max, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13));
  return max[0] > max[1] ? max[0] : max[1];
}

}  // namespace dapple
