// The inner loops of a binned SAH build (Wald, "On fast Construction of SAH-based Bounding
// Volume Hierarchies", 2007): primitives into bins, the cheapest split, partition.
#pragma once

#include <array>
#include <cstdint>

#include "bvh/build/primitive_box.hpp"

namespace dapple {

inline constexpr int kBins = 16;

/// Maps centres to bins. An axis along which all centres are equal has scale 0.
struct Binning {
  float start[4], scale[4];
  int used;  ///< bins per axis

  /// For `count` primitives with twice their centres inside `centres2`.
  Binning(const Box8& centres2, std::uint32_t count);
};

/// Boxes and numbers of the primitives in each bin. Indexed by bin, then by axis, so that few bins
/// occupy few cache lines. Only the first Binning::used bins are set.
struct Bins {
  std::array<std::array<Box8, 3>, kBins> box;
  std::array<std::array<std::uint32_t, 3>, kBins> count;

  void fill(const PrimitiveBox* prims, std::uint32_t prim_count, const Binning& binning);
  void add(const Bins& other, int used);
};

struct Split {
  float cost;         ///< sum over both sides of area times number of primitives
  int axis = -1;      ///< -1: all centres are equal
  int last_left = 0;  ///< bins up to this one go left
};

Split best_split(const Bins& bins, int used);

/// Copies `prims` to `left` and `right` in the same order; either may be `prims` itself. Adds their
/// centres to `centres2`: [0] left, [1] right. Returns the number of primitives on the left.
std::uint32_t partition(const PrimitiveBox* prims, std::uint32_t count, const Binning& binning,
                        const Split& split, PrimitiveBox* left, PrimitiveBox* right,
                        Box8 (&centres2)[2]);

/// Adds the boxes of `prims` to `box`, and their centres to `centres2`.
void measure(const PrimitiveBox* prims, std::uint32_t count, Box8& box, Box8& centres2);

}  // namespace dapple
