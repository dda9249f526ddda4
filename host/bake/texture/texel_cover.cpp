#include "bake/texture/texel_cover.hpp"

#include <algorithm>
#include <cmath>

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

/// Calls visit(x, y) for each texel in which the triangle has an area.
template <class Visit>
void visit_texels(const V2f* uv, std::uint32_t size, Visit visit) {
  const auto scale = static_cast<float>(size);
  V2f low(uv[0]), high(uv[0]);
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(uv[k].x) || !std::isfinite(uv[k].y)) return;
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = std::min(low[axis], uv[k][axis]);
      high[axis] = std::max(high[axis], uv[k][axis]);
    }
  }
  const auto texel = [&](float x) {
    return static_cast<std::uint32_t>(std::clamp(x * scale, 0.0f, scale - 1));
  };
  for (std::uint32_t y = texel(low.y); y <= texel(high.y); ++y)
    for (std::uint32_t x = texel(low.x); x <= texel(high.x); ++x)
      if (clip_to_texel(uv, size, x, y).area() > kMinArea) visit(y * size + x);
}

}  // namespace

float TexelPolygon::area() const {
  float twice = 0;
  for (std::size_t i = 2; i < count; ++i)
    twice += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
  return 0.5f * std::fabs(twice);
}

TexelPolygon clip_to_texel(const V2f* uv, std::uint32_t size, std::uint32_t x, std::uint32_t y) {
  TexelPolygon polygon;
  for (; polygon.count < 3; ++polygon.count)
    polygon.corners[polygon.count] = uv[polygon.count] * static_cast<float>(size);
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
  std::vector<std::uint32_t> count(std::size_t{size} * size);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    visit_texels(&corners[i], size, [&](std::uint32_t texel) { ++count[texel]; });
  TexelCover cover;
  std::uint32_t sum = 0;
  for (std::uint32_t texel = 0; texel < count.size(); ++texel) {
    if (count[texel] == 0) continue;
    cover.texel.push_back(texel);
    cover.first.push_back(sum);
    sum += count[texel];
    count[texel] = cover.first.back();  // from here on where its next triangle goes
  }
  cover.first.push_back(sum);
  cover.triangles.resize(sum);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    visit_texels(&corners[i], size, [&](std::uint32_t texel) {
      cover.triangles[count[texel]++] = static_cast<std::uint32_t>(i / 3);
    });
  return cover;
}

}  // namespace dapple
