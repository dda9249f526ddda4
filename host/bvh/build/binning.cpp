#include "bvh/build/binning.hpp"

#include "bvh/build/multiversion.hpp"

namespace dapple {
namespace {

/// Number of bins: fewer for few primitives, for which setting up bins would cost more than they
/// save.
int bins_for(std::uint32_t count) { return count >= 32 ? kBins : 8; }

}  // namespace

Binning::Binning(const Box8& centres2, std::uint32_t count) : used(bins_for(count)) {
  for (int a = 0; a < 4; ++a) {
    start[a] = a < 3 ? centres2.bounds[a] : 0.0f;
    const float size = a < 3 ? -centres2.bounds[4 + a] - start[a] : 0.0f;
    const float bins = static_cast<float>(used);
    scale[a] = size > 0.0f && bins / size < 1e30f ? bins * 0.99999f / size : 0.0f;
  }
}

DAPPLE_MULTIVERSION
void Bins::fill(const PrimitiveBox* prims, std::uint32_t prim_count, const Binning& binning) {
  for (int b = 0; b < binning.used; ++b) {
    for (int a = 0; a < 3; ++a) box[b][a].clear();
    count[b] = {};
  }
  Float4 start, scale;
  std::memcpy(&start, binning.start, sizeof start);
  std::memcpy(&scale, binning.scale, sizeof scale);
  const Float4 zero{}, last = zero + static_cast<float>(binning.used - 1);
  for (std::uint32_t i = 0; i < prim_count; ++i) {
    Float8 bounds;
    load_box(prims[i], bounds);
    Float4 half[2];
    std::memcpy(half, &bounds, sizeof half);
    Float4 at = (half[0] - half[1] - start) * scale;
    at = at > zero ? at : zero;  // 0 for NaN too
    const Int4 bin = __builtin_convertvector(at < last ? at : last, Int4);
    for (int a = 0; a < 3; ++a) {
      box[bin[a]][a].add(bounds);
      ++count[bin[a]][a];
    }
  }
}

void Bins::add(const Bins& other, int used) {
  for (int b = 0; b < used; ++b) {
    for (int a = 0; a < 3; ++a) {
      box[b][a].add(other.box[b][a]);
      count[b][a] += other.count[b][a];
    }
  }
}

DAPPLE_MULTIVERSION
Split best_split(const Bins& bins, int used) {
  Split best{std::numeric_limits<float>::infinity()};
  for (int a = 0; a < 3; ++a) {
    std::array<float, kBins> right_cost;
    Box8 box;
    box.clear();
    std::uint32_t count = 0;
    for (int b = used - 1; b > 0; --b) {
      box.add(bins.box[b][a]);
      count += bins.count[b][a];
      right_cost[b] = count ? box.half_area() * static_cast<float>(count) : -1.0f;
    }
    box.clear();
    count = 0;
    for (int b = 0; b + 1 < used; ++b) {
      box.add(bins.box[b][a]);
      count += bins.count[b][a];
      if (count == 0 || right_cost[b + 1] < 0.0f) continue;
      const float cost = box.half_area() * static_cast<float>(count) + right_cost[b + 1];
      if (cost < best.cost) best = {cost, a, b};
    }
  }
  return best;
}

DAPPLE_MULTIVERSION
std::uint32_t partition(const PrimitiveBox* prims, std::uint32_t count, const Binning& binning,
                        const Split& split, PrimitiveBox* left, PrimitiveBox* right,
                        Box8 (&centres2)[2]) {
  const int axis = split.axis;
  const float start = binning.start[axis], scale = binning.scale[axis];
  const float first_right = static_cast<float>(split.last_left + 1);
  // Without branches, since the side is unpredictable: adding infinity to a centre excludes it from
  // the bounds of the other side.
  const Float8 zero{}, infinity = zero + std::numeric_limits<float>::infinity();
  const Float8 aside[2] = {zero, infinity};
  Box8 sides[2] = {centres2[0], centres2[1]};
  std::uint32_t left_count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    Float8 bytes, bounds, centre2;
    std::memcpy(&bytes, &prims[i], sizeof bytes);
    load_box(prims[i], bounds);
    centre2_of(bounds, centre2);
    const float at = (prims[i].lower[axis] - prims[i].minus_upper[axis] - start) * scale;
    const unsigned goes_right = at >= first_right;
    sides[0].add(centre2 + aside[goes_right]);
    sides[1].add(centre2 + aside[1 - goes_right]);
    PrimitiveBox* const ends[2] = {left + left_count, right + (i - left_count)};
    std::memcpy(ends[goes_right], &bytes, sizeof bytes);
    left_count += 1 - goes_right;
  }
  centres2[0] = sides[0];
  centres2[1] = sides[1];
  return left_count;
}

DAPPLE_MULTIVERSION
void measure(const PrimitiveBox* prims, std::uint32_t count, Box8& box, Box8& centres2) {
  Box8 boxes = box, centres = centres2;
  for (std::uint32_t i = 0; i < count; ++i) {
    Float8 bounds, centre2;
    load_box(prims[i], bounds);
    centre2_of(bounds, centre2);
    boxes.add(bounds);
    centres.add(centre2);
  }
  box = boxes;
  centres2 = centres;
}

}  // namespace dapple
