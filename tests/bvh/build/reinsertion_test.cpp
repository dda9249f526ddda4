// Reinsertion of a binary tree's subtrees: the result is a valid tree over the same primitives,
// with a smaller sum of areas.
#include "bvh/build/reinsertion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>

namespace dapple {
namespace {

/// Random boxes: most are small like leaves, every tenth is long like a branch.
std::vector<PrimitiveBox> random_boxes(std::uint32_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> position(0.0f, 1.0f);
  std::vector<PrimitiveBox> boxes;
  for (std::uint32_t i = 0; i < count; ++i) {
    const V3f corner(position(random), position(random), position(random));
    const float length = i % 10 == 0 ? 0.5f : 0.02f;
    boxes.push_back(
        primitive_box({corner, corner + V3f(0.01f, length, 0.02f) * (0.5f + position(random))}, i));
  }
  return boxes;
}

std::vector<BinaryNode> build(std::vector<PrimitiveBox>& boxes) {
  std::vector<PrimitiveBox> second(boxes.size());
  const Splitter splitter(boxes, second, 4);
  Part whole = splitter.all();
  splitter.move_to_result(whole);
  return build_binary_tree(splitter, whole);
}

double area_sum(const std::vector<BinaryNode>& tree) {
  double sum = 0;
  for (const BinaryNode& node : tree) sum += node.area;
  return sum;
}

/// Checks that each node's box is that of its primitives, and that its range of primitives joins
/// those of its children.
void expect_sound(const std::vector<BinaryNode>& tree, const std::vector<PrimitiveBox>& boxes,
                  std::uint32_t n = 0) {
  const BinaryNode& node = tree[n];
  Box8 box, centres;
  box.clear();
  centres.clear();
  measure(boxes.data() + node.first, node.count, box, centres);
  EXPECT_EQ(box.box(), node.box.box()) << n;
  EXPECT_EQ(node.area, node.box.half_area()) << n;
  if (node.right == 0) return;
  const BinaryNode &left = tree[n + 1], &right = tree[node.right];
  EXPECT_EQ(left.first, node.first);
  EXPECT_EQ(right.first, left.first + left.count);
  EXPECT_EQ(left.count + right.count, node.count);
  expect_sound(tree, boxes, n + 1);
  expect_sound(tree, boxes, node.right);
}

/// Runs two rounds of reinsertion. Returns the sum of areas after them, relative to the one before.
double part_left(std::vector<PrimitiveBox>& boxes) {
  std::vector<BinaryNode> tree = build(boxes);
  const double before = area_sum(tree);
  reinsert_subtrees(2, boxes, tree);
  EXPECT_EQ(tree[0].count, boxes.size());
  expect_sound(tree, boxes);
  return area_sum(tree) / before;
}

TEST(Reinsertion, LowersTheSumOfAreasAndLosesNothing) {
  std::vector<PrimitiveBox> boxes = random_boxes(3000);
  std::vector<BinaryNode> tree = build(boxes);
  expect_sound(tree, boxes);
  const std::size_t nodes = tree.size();
  const double before = area_sum(tree);
  reinsert_subtrees(1, boxes, tree);
  const double after_one = area_sum(tree);
  reinsert_subtrees(1, boxes, tree);
  EXPECT_LT(after_one, 0.97 * before);
  EXPECT_LT(area_sum(tree), after_one);
  EXPECT_EQ(tree.size(), nodes);
  expect_sound(tree, boxes);
  std::vector<bool> seen(boxes.size());
  for (const PrimitiveBox& box : boxes) seen[box.primitive] = true;
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](bool is) { return is; }));
}

TEST(Reinsertion, TreesWithoutGrandparentsStayAsTheyAre) {
  for (const std::uint32_t count : {1u, 5u, 6u}) {
    std::vector<PrimitiveBox> boxes = random_boxes(count);
    std::vector<BinaryNode> tree = build(boxes);
    reinsert_subtrees(3, boxes, tree);
    expect_sound(tree, boxes);
    EXPECT_EQ(tree[0].count, count);
  }
}

TEST(Reinsertion, NestedBoxesMakeNoChain) {
  std::vector<PrimitiveBox> boxes;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const V3f corner(static_cast<float>(i + 1));
    boxes.push_back(primitive_box({-corner, corner}, i));
  }
  EXPECT_EQ(part_left(boxes), 1);
}

// No box contains another, and all have the same centre: a search without a limit would visit
// nearly all nodes, and take far too long.
TEST(Reinsertion, OverlappingBoxesTakeLimitedTime) {
  std::mt19937 random(9);
  std::normal_distribution<float> exponent(0.0f, 1.0f);
  std::vector<PrimitiveBox> boxes;
  for (std::uint32_t i = 0; i < 1u << 15; ++i) {
    const float x = std::exp(exponent(random)), y = std::exp(exponent(random));
    const V3f corner(x, y, 1 / (x * y));
    boxes.push_back(primitive_box({-corner, corner}, i));
  }
  // Processor time, of all threads: other programs disturb it little.
  const std::clock_t start = std::clock();
  EXPECT_LE(part_left(boxes), 1);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  EXPECT_LT(seconds, 5);
}

TEST(Reinsertion, InfiniteAreasAreLeftAlone) {
  std::vector<PrimitiveBox> boxes = random_boxes(100);
  for (PrimitiveBox& box : boxes)
    for (int a = 0; a < 3; ++a) box.lower[a] *= 2e19f, box.minus_upper[a] *= 2e19f;
  std::vector<BinaryNode> tree = build(boxes);
  ASSERT_FALSE(std::isfinite(tree[0].area));
  reinsert_subtrees(2, boxes, tree);
  EXPECT_EQ(tree[0].count, 100u);
}

TEST(Reinsertion, EqualBoxesAreNotMoved) {
  std::vector<PrimitiveBox> boxes(200, random_boxes(1)[0]);
  for (std::uint32_t i = 0; i < 200; ++i) boxes[i].primitive = i;
  EXPECT_EQ(part_left(boxes), 1);
  for (std::uint32_t i = 0; i < 200; ++i) EXPECT_EQ(boxes[i].primitive, i);
}

}  // namespace
}  // namespace dapple
