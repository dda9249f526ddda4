// A row of a coverage map in one to four vector registers.
#pragma once

#include <cstring>

#include "bvh/coverage_map.hpp"

namespace dapple {

using Row = float __attribute__((vector_size(kMapSize * sizeof(float))));

// By reference: a vector wider than the instruction set's has no calling convention.
inline void load_row(const float* from, Row& row) { std::memcpy(&row, from, sizeof row); }
inline void store_row(float* to, const Row& row) { std::memcpy(to, &row, sizeof row); }

}  // namespace dapple
