#include "device/upload/emitter_tree.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "device/upload/stored_vector.hpp"

namespace dapple {
namespace {

/// Nodes of fewer triangles are divided by one thread.
constexpr std::size_t kGrain = 4096;
/// Boxes are stored larger by this part of their largest coordinate, more than roundings.
constexpr float kRounding = 1e-6f;

Box3f box_of(const EmitterTriangle& t) {
  const V3f vertex = vector_of(t.vertex);
  Box3f box(vertex);
  box.extendBy(vertex + vector_of(t.edge1));
  box.extendBy(vertex + vector_of(t.edge2));
  return box;
}

void store_box(const Box3f& box, float (&stored)[6]) {
  for (int axis = 0; axis < 3; ++axis) {
    const float low = box.min[axis], high = box.max[axis];
    stored[axis] = 0.5f * low + 0.5f * high;
    stored[axis + 3] =
        0.5f * high - 0.5f * low + kRounding * std::max(std::fabs(low), std::fabs(high));
  }
}

/// A triangle is long if its longest side is longer than this many of its heights above it, and if
/// it is no line.
constexpr double kLong = 3, kNeverLong = 1e5;
/// How many triangles of a light may be added, and how many a piece of a longest side stands for.
constexpr double kMostPieces = 1 << 17, kPiecesOfSide = 4;

double longest_side(const EmitterTriangle& t) {
  const V3f edge1 = vector_of(t.edge1), edge2 = vector_of(t.edge2);
  return std::sqrt(double{std::max({edge1.length2(), edge2.length2(), (edge2 - edge1).length2()})});
}

double twice_area(const EmitterTriangle& t) {
  return vector_of(t.edge1).cross(vector_of(t.edge2)).length();
}

/// How many pieces of `heights` times its height above it the longest side of a triangle has; 0 of
/// lines.
double pieces_of_side(const EmitterTriangle& t, double heights) {
  const double longest = longest_side(t), sides = longest * longest / twice_area(t);
  return sides < kNeverLong ? sides / heights : 0;
}

/// Appends a triangle, which is a part of `whole`.
void append_piece(const EmitterTriangle& whole, const V3f& a, const V3f& b, const V3f& c,
                  std::vector<EmitterTriangle>& pieces) {
  EmitterTriangle piece{};
  store(a, piece.vertex);
  store(b - a, piece.edge1);
  store(c - a, piece.edge2);
  const double share = double{(b - a).cross(c - a).length()} / twice_area(whole);
  piece.area = static_cast<float>(share * double{whole.area});
  if (piece.area > 0) pieces.push_back(piece);
}

/// Cuts the part apex, p, q of `whole` along lines parallel to p, q. Its longest side has `sides`
/// pieces.
void append_slices(const EmitterTriangle& whole, const V3f& apex, const V3f& p, const V3f& q,
                   double sides, std::vector<EmitterTriangle>& pieces) {
  const double longest = std::max((p - apex).length(), (q - apex).length());
  const auto slices =
      static_cast<int>(std::max(1.0, std::ceil(sides * longest / longest_side(whole))));
  const auto at = [&](const V3f& corner, int i) {
    return apex + (corner - apex) * (static_cast<float>(i) / static_cast<float>(slices));
  };
  for (int i = 0; i < slices; ++i) {
    append_piece(whole, at(p, i), at(p, i + 1), at(q, i + 1), pieces);
    if (i > 0) append_piece(whole, at(p, i), at(q, i + 1), at(q, i), pieces);
  }
}

/// Cuts a triangle into slices across its longest side, from its height on to both ends.
void append_pieces(const EmitterTriangle& t, double sides, std::vector<EmitterTriangle>& pieces) {
  if (!(sides > 1)) return pieces.push_back(t);
  const V3f corners[3] = {vector_of(t.vertex), vector_of(t.vertex) + vector_of(t.edge1),
                          vector_of(t.vertex) + vector_of(t.edge2)};
  const auto side = [&](int k) { return corners[(k + 1) % 3] - corners[k]; };
  int longest = 0;  // the side from this corner to the next
  for (int k = 1; k < 3; ++k)
    if (side(k).length2() > side(longest).length2()) longest = k;
  const V3f &from = corners[longest], &to = corners[(longest + 1) % 3],
            &above = corners[(longest + 2) % 3];
  const float along = (above - from).dot(side(longest)) / side(longest).length2();
  const V3f foot = from + side(longest) * std::clamp(along, 0.0f, 1.0f);
  append_slices(t, from, foot, above, sides, pieces);
  append_slices(t, to, above, foot, sides, pieces);
}

/// What a node passes to the one above.
struct Part {
  Box3f box;
  double area = 0;
};

class EmitterTree {
 public:
  explicit EmitterTree(std::span<const EmitterTriangle> unordered)
      : triangles_(unordered.begin(), unordered.end()), order_(unordered.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    for (const EmitterTriangle& t : triangles_)
      centres_.push_back(vector_of(t.vertex) +
                         (vector_of(t.edge1) + vector_of(t.edge2)) * (1.0f / 3));
  }

  /// Divides the node [first, end), which has triangles, and stores them where they come to lie.
  Part divide(std::size_t first, std::size_t end, std::span<EmitterTriangle> ordered) {
    if (end - first == 1) {
      ordered[first] = triangles_[order_[first]];
      return {box_of(ordered[first]), double{ordered[first].area}};
    }
    const std::size_t middle = (first + end) / 2;
    part(first, middle, end);
    Part left, right;
    const auto divide_left = [&] { left = divide(first, middle, ordered); };
    const auto divide_right = [&] { right = divide(middle, end, ordered); };
    if (end - first < kGrain) {
      divide_left();
      divide_right();
    } else {
      tbb::parallel_invoke(divide_left, divide_right);
    }
    const double area = left.area + right.area;
    EmitterTriangle& node = ordered[middle];
    node.left_share = area > 0 ? static_cast<float>(left.area / area) : 0.5f;
    store_box(left.box, node.left);
    store_box(right.box, node.right);
    left.box.extendBy(right.box);
    return {left.box, area};
  }

 private:
  /// Orders the triangles of a node so that those left of `middle` lie before the others.
  void part(std::size_t first, std::size_t middle, std::size_t end) {
    Box3f box;
    for (std::size_t i = first; i < end; ++i) box.extendBy(centres_[order_[i]]);
    const auto axis = static_cast<int>(box.majorAxis());
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return centres_[a][axis] != centres_[b][axis] ? centres_[a][axis] < centres_[b][axis] : a < b;
    });
  }

  std::vector<EmitterTriangle> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<V3f> centres_;
};

}  // namespace

void divide_long_emitters(std::vector<EmitterTriangle>& triangles) {
  double lengths = kLong;  // of pieces, in heights of their triangle
  const auto needed = [&] {
    double sum = 0;
    for (const EmitterTriangle& t : triangles)
      if (const double sides = pieces_of_side(t, lengths); sides > 1) sum += kPiecesOfSide * sides;
    return sum;
  };
  while (needed() > kMostPieces) lengths *= 2;
  std::vector<EmitterTriangle> pieces;
  for (const EmitterTriangle& t : triangles) append_pieces(t, pieces_of_side(t, lengths), pieces);
  triangles = std::move(pieces);
}

void order_emitters(std::span<EmitterTriangle> triangles) {
  EmitterTree(triangles).divide(0, triangles.size(), triangles);
}

}  // namespace dapple
