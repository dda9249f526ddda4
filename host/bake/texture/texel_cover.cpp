#include "bake/texture/texel_cover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Parts of a texel that are smaller are rounding errors.
constexpr float kMinArea = 1e-6f;

/// Of texture coordinates up to 1.
constexpr float kRounding = 1e-7f;

/// Keeps the part of the polygon where sign * (p[axis] - limit) >= 0 (Sutherland and Hodgman,
/// "Reentrant Polygon Clipping", 1974).
TexelPolygon cut(const TexelPolygon& polygon, int axis, float limit, float sign) {
  TexelPolygon out;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const V2f& a = polygon.corners[i];
    const V2f& b = polygon.corners[(i + 1) % polygon.count];
    const float da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
    if (da >= 0 && out.count < TexelPolygon::kMaxCorners) out.corners[out.count++] = a;
    if ((da >= 0) != (db >= 0) && out.count < TexelPolygon::kMaxCorners)
      out.corners[out.count++] = a + (b - a) * (da / (da - db));
  }
  return out;
}

/// A triangle in units of texels.
TexelPolygon in_texels(const V2f* uv, std::uint32_t size) {
  TexelPolygon polygon;
  for (; polygon.count < 3; ++polygon.count)
    polygon.corners[polygon.count] = uv[polygon.count] * static_cast<float>(size);
  return polygon;
}

/// The least and the largest coordinate.
std::pair<float, float> extent(const TexelPolygon& polygon, int axis) {
  float low = polygon.corners[0][axis], high = low;
  for (std::size_t i = 1; i < polygon.count; ++i) {
    low = std::min(low, polygon.corners[i][axis]);
    high = std::max(high, polygon.corners[i][axis]);
  }
  return {low, high};
}

/// Calls visit(x, y) for each texel in which the triangle has an area. Only the texels of a row
/// between the triangle's sides there are looked at: long thin ones have large rectangles.
template <class Visit>
void visit_texels(const V2f* uv, std::uint32_t size, Visit visit) {
  constexpr float kBeside = 0.01f;  // texels: more than the rounding of where sides cross a row
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(uv[k].x) || !std::isfinite(uv[k].y)) return;
  const auto texel = [&](float x) {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0f, static_cast<float>(size - 1)));
  };
  const TexelPolygon triangle = in_texels(uv, size);
  const auto [top, bottom] = extent(triangle, 1);
  for (std::uint32_t y = texel(top); y <= texel(bottom); ++y) {
    const auto row = static_cast<float>(y);
    const TexelPolygon in_row = cut(cut(triangle, 1, row - kBeside, 1), 1, row + 1 + kBeside, -1);
    if (in_row.count == 0) continue;
    const auto [left, right] = extent(in_row, 0);
    for (std::uint32_t x = texel(left - kBeside); x <= texel(right + kBeside); ++x)
      if (clip_to_texel(uv, size, x, y).area() > kMinArea) visit(x, y);
  }
}

/// A counter for each texel, in blocks of texels that are made at the first use: the charts of a
/// small mesh are a few of them, wherever in the texture they lie.
class TexelCounters {
 public:
  explicit TexelCounters(std::uint32_t size)
      : size_(size),
        blocks_each_way_((size + kBlock - 1) / kBlock),
        blocks_(std::size_t{blocks_each_way_} * blocks_each_way_) {}

  std::uint32_t& at(std::uint32_t x, std::uint32_t y) {
    auto& block = blocks_[std::size_t{y / kBlock} * blocks_each_way_ + x / kBlock];
    if (!block) block = std::make_unique<std::uint32_t[]>(std::size_t{kBlock} * kBlock);
    return block[std::size_t{y % kBlock} * kBlock + x % kBlock];
  }

  /// Calls visit(texel, counter) for each counter above 0, by increasing texels.
  template <class Visit>
  void for_each(Visit visit) {
    for (std::uint32_t top = 0; top < size_; top += kBlock) {
      const auto row = std::span(blocks_).subspan(std::size_t{top / kBlock} * blocks_each_way_,
                                                  blocks_each_way_);
      if (std::none_of(row.begin(), row.end(), [](const auto& block) { return bool(block); }))
        continue;
      for (std::uint32_t y = top; y < std::min(top + kBlock, size_); ++y)
        for (std::uint32_t b = 0; b < blocks_each_way_; ++b)
          for (std::uint32_t x = 0; row[b] && x < kBlock; ++x)
            if (std::uint32_t& counter = row[b][std::size_t{y - top} * kBlock + x]; counter > 0)
              visit(y * size_ + b * kBlock + x, counter);
    }
  }

 private:
  static constexpr std::uint32_t kBlock = 64;  ///< texels along its side

  std::uint32_t size_, blocks_each_way_;
  std::vector<std::unique_ptr<std::uint32_t[]>> blocks_;  ///< row by row; none: all are 0
};

}  // namespace

float TexelPolygon::area() const {
  float twice = 0;
  for (std::size_t i = 2; i < count; ++i)
    twice += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
  return 0.5f * std::fabs(twice);
}

TexelPolygon clip_to_texel(const V2f* uv, std::uint32_t size, std::uint32_t x, std::uint32_t y) {
  TexelPolygon polygon = in_texels(uv, size);
  const auto left = static_cast<float>(x), top = static_cast<float>(y);
  polygon = cut(polygon, 0, left, 1);
  polygon = cut(polygon, 0, left + 1, -1);
  polygon = cut(polygon, 1, top, 1);
  return cut(polygon, 1, top + 1, -1);
}

// Corners on one line are off it by their rounding, so that a triangle of them has an area.
bool has_texel_area(const V2f* uv, std::uint32_t size) {
  const V2f a = uv[1] - uv[0], b = uv[2] - uv[0];
  const float longest = std::max({a.length2(), b.length2(), (b - a).length2()});
  const float scale = static_cast<float>(size) * static_cast<float>(size);
  const float area = 0.5f * std::fabs(a.cross(b));
  return area * scale > kMinArea && area > kRounding * std::sqrt(longest);
}

TexelCover cover_texels(std::span<const V2f> corners, std::uint32_t size) {
  TexelCounters counters(size);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    visit_texels(&corners[i], size, [&](std::uint32_t x, std::uint32_t y) { ++counters.at(x, y); });
  TexelCover cover;
  std::size_t sum = 0;
  counters.for_each([&](std::uint32_t texel, std::uint32_t& counter) {
    cover.texel.push_back(texel);
    cover.first.push_back(static_cast<std::uint32_t>(sum));
    sum += counter;
    if (sum > std::numeric_limits<std::uint32_t>::max())
      throw Error(ErrorKind::input,
                  "the texture coordinates overlap too much: more than 4,294,967,295 pairs of a "
                  "texel and a triangle");
    counter = cover.first.back();  // from here on where its next triangle goes
  });
  cover.first.push_back(static_cast<std::uint32_t>(sum));
  cover.triangles.resize(sum);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    visit_texels(&corners[i], size, [&](std::uint32_t x, std::uint32_t y) {
      cover.triangles[counters.at(x, y)++] = static_cast<std::uint32_t>(i / 3);
    });
  return cover;
}

}  // namespace dapple
