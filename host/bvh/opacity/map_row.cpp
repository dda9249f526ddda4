// The rows that Row::zero() and Row::one() load.
#include "bvh/opacity/map_row.hpp"

namespace dapple {

const std::array<float, kMapSize> kZeroRow = {};
const std::array<float, kMapSize> kOneRow = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

}  // namespace dapple
