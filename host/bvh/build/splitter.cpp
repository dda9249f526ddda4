#include "bvh/build/splitter.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "bvh/build/multiversion.hpp"
#include "bvh/build/surface_cost.hpp"

namespace dapple {
namespace {

/// From this depth on, ranges are halved, which bounds the depth for any input.
constexpr int kDeepest = 48;
/// For up to this many primitives all splits are tried.
constexpr std::uint32_t kFew = 4;
constexpr std::uint32_t kParallelSplit = 1u << 16;
constexpr std::uint32_t kBlock = 1u << 13;

/// The cheapest split of a few primitives, and the cost of both sides as leaves.
struct FewSplit {
  float cost;
  unsigned left_set;
};

DAPPLE_MULTIVERSION
FewSplit best_of_all(const PrimitiveBox* prims, std::uint32_t count) {
  Box8 box[1u << kFew];  // of each set of primitives
  float cost[1u << kFew];
  const unsigned everything = (1u << count) - 1;
  for (unsigned set = 1; set < everything; ++set) {
    load_box(prims[__builtin_ctz(set)], box[set].bounds);
    const unsigned rest = set & (set - 1);
    if (rest) box[set].add(box[rest]);
    cost[set] = leaf_cost(box[set].half_area(), static_cast<unsigned>(__builtin_popcount(set)));
  }
  // The last primitive always goes right, so every split is tried once.
  FewSplit best{std::numeric_limits<float>::infinity(), 1};
  for (unsigned set = 1; set <= everything / 2; ++set) {
    const float both = cost[set] + cost[everything ^ set];
    if (both < best.cost) best = {both, set};
  }
  return best;
}

/// Divides the range of `part` into two sides, without new boxes and bounds of centres.
void divide(Part& part, Part& right, std::uint32_t left_count) {
  right = part;
  right.first = part.first + left_count;
  right.count = part.count - left_count;
  part.count = left_count;
  ++part.depth;
  ++right.depth;
}

DAPPLE_MULTIVERSION
void join_bins(const Bins& bins, const Split& split, int used, Box8& left, Box8& right) {
  left.clear();
  right.clear();
  for (int b = 0; b < used; ++b) (b <= split.last_left ? left : right).add(bins.box[b][split.axis]);
}

}  // namespace

Part Splitter::all() const {
  Part part;
  part.count = count_;
  part.box.clear();
  part.centres2.clear();
  const std::uint32_t blocks = (count_ + kBlock - 1) / kBlock;
  std::vector<Part> measured(blocks, part);
  tbb::parallel_for(0u, blocks, [&](std::uint32_t b) {
    const std::uint32_t first = b * kBlock;
    measure(result_ + first, std::min(kBlock, count_ - first), measured[b].box,
            measured[b].centres2);
  });
  for (const Part& block : measured) {
    part.box.add(block.box);
    part.centres2.add(block.centres2);
  }
  evaluate_leaf(part);
  return part;
}

void Splitter::evaluate_leaf(Part& part) const {
  part.area = part.box.half_area();
  part.leaf = part.count == 1;
  if (part.count == 1 || part.count > kFew) return;
  const FewSplit best = best_of_all(at(part), part.count);
  part.left_set = best.left_set;
  part.leaf = part.count <= leaf_size_ && best.cost >= leaf_cost(part.area, part.count);
}

void Splitter::split(Part& part, Part& right) const {
  if (part.count <= kFew) {
    split_few(part, right);
  } else if (part.count > kParallelSplit) {
    split_in_parallel(part, right);
  } else {
    const Binning binning(part.centres2, part.count);
    Bins bins;
    bins.fill(at(part), part.count, binning);
    const Split split = best_split(bins, binning.used);
    if (split.axis < 0 || part.depth >= kDeepest) return halve(part, right);
    PrimitiveBox* const prims = at(part);
    PrimitiveBox* const aside = (part.in_scratch ? result_ : scratch_) + part.first;
    Box8 centres2[2];
    centres2[0].clear();
    centres2[1].clear();
    const std::uint32_t left_count =
        partition(prims, part.count, binning, split, prims, aside, centres2);
    std::copy_n(aside, part.count - left_count, prims + left_count);
    divide(part, right, left_count);
    part.centres2 = centres2[0];
    right.centres2 = centres2[1];
    join_bins(bins, split, binning.used, part.box, right.box);
  }
  evaluate_leaf(part);
  evaluate_leaf(right);
}

void Splitter::split_few(Part& part, Part& right) const {
  PrimitiveBox* const prims = at(part);
  PrimitiveBox sides[2][kFew];
  std::uint32_t counts[2] = {0, 0};
  for (std::uint32_t i = 0; i < part.count; ++i) {
    const unsigned side = (part.left_set >> i & 1u) ^ 1u;
    sides[side][counts[side]++] = prims[i];
  }
  std::copy_n(sides[0], counts[0], prims);
  std::copy_n(sides[1], counts[1], prims + counts[0]);
  divide(part, right, counts[0]);
  for (Part* side : {&part, &right}) {
    side->box.clear();
    measure(at(*side), side->count, side->box, side->centres2);
  }
}

void Splitter::halve(Part& part, Part& right) const {
  divide(part, right, part.count / 2);
  for (Part* side : {&part, &right}) {
    side->box.clear();
    side->centres2.clear();
    measure(at(*side), side->count, side->box, side->centres2);
    evaluate_leaf(*side);
  }
}

void Splitter::split_in_parallel(Part& part, Part& right) const {
  const Binning binning(part.centres2, part.count);
  const std::uint32_t blocks = (part.count + kBlock - 1) / kBlock;
  const auto size_of = [&](std::uint32_t b) { return std::min(kBlock, part.count - b * kBlock); };
  const PrimitiveBox* const from = at(part);
  std::vector<Bins> bins(blocks);
  tbb::parallel_for(0u, blocks, [&](std::uint32_t b) {
    bins[b].fill(from + b * std::size_t{kBlock}, size_of(b), binning);
  });
  Bins all = bins[0];
  for (std::uint32_t b = 1; b < blocks; ++b) all.add(bins[b], binning.used);
  const Split split = best_split(all, binning.used);
  if (split.axis < 0 || part.depth >= kDeepest) return halve(part, right);
  // The bins tell how many primitives of each block go left, so all blocks can write in parallel.
  std::vector<std::uint32_t> left_before(blocks + 1, 0);
  for (std::uint32_t b = 0; b < blocks; ++b) {
    left_before[b + 1] = left_before[b];
    for (int bin = 0; bin <= split.last_left; ++bin) {
      left_before[b + 1] += bins[b].count[bin][split.axis];
    }
  }
  const std::uint32_t left_count = left_before[blocks];
  PrimitiveBox* const to = (part.in_scratch ? result_ : scratch_) + part.first;
  struct Sides {
    Box8 centres2[2];
  };
  std::vector<Sides> sides(blocks);
  tbb::parallel_for(0u, blocks, [&](std::uint32_t b) {
    for (Box8& side : sides[b].centres2) side.clear();
    partition(from + b * std::size_t{kBlock}, size_of(b), binning, split, to + left_before[b],
              to + left_count + (b * kBlock - left_before[b]), sides[b].centres2);
  });
  divide(part, right, left_count);
  part.in_scratch = right.in_scratch = !part.in_scratch;
  part.centres2 = sides[0].centres2[0];
  right.centres2 = sides[0].centres2[1];
  for (const Sides& block : sides) {
    part.centres2.add(block.centres2[0]);
    right.centres2.add(block.centres2[1]);
  }
  join_bins(all, split, binning.used, part.box, right.box);
}

void Splitter::move_to_result(Part& part) const {
  if (!part.in_scratch) return;
  std::copy_n(scratch_ + part.first, part.count, result_ + part.first);
  part.in_scratch = false;
}

}  // namespace dapple
