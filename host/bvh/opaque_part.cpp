#include "bvh/opaque_part.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bvh/convex_polygon.hpp"
#include "bvh/triangle_opacity.hpp"

namespace dapple {
namespace {

constexpr int kHalvings = 5;

/// The bounds' directions.
std::array<float, 4> along_axes(V2f at) { return {at.x, at.y, at.x + at.y, at.x - at.y}; }

bool holds(const OpaquePart& part, V2f at) {
  const std::array<float, 4> along = along_axes(at);
  for (std::size_t axis = 0; axis < along.size(); ++axis) {
    if (along[axis] < part.least[axis] || along[axis] > part.most[axis]) return false;
  }
  return true;
}

void extend(OpaquePart& part, V2f at) {
  const std::array<float, 4> along = along_axes(at);
  for (std::size_t axis = 0; axis < along.size(); ++axis) {
    part.least[axis] = std::min(part.least[axis], along[axis]);
    part.most[axis] = std::max(part.most[axis], along[axis]);
  }
}

/// The least alpha of a texel, 0 to 255, that may hide something, or nothing if all does.
int least_texel(const Material& material, const std::array<float, 3>& vertex_alpha) {
  const float factor =
      material.alpha * std::max({vertex_alpha[0], vertex_alpha[1], vertex_alpha[2]});
  if (!(factor > 0.0f)) return cutoff_of(material) == 0.0f ? 0 : 256;
  // One less, for rounding.
  const float cutoff = std::ceil(cutoff_of(material) * 255.0f / factor) - 1.0f;
  return cutoff_of(material) == 0.0f ? 0 : static_cast<int>(std::clamp(cutoff, 1.0f, 256.0f));
}

/// The search through one triangle.
struct Search {
  const TexelMaxima& maxima;
  const TexturedCorners& corners;
  int least;
  OpaquePart part = OpaquePart::nothing();

  [[nodiscard]] V2f uv(V2f at) const {
    const auto& [a, b, c] = corners.uv;
    return a * (1.0f - at.x - at.y) + b * at.x + c * at.y;
  }

  [[nodiscard]] bool may_hide(V2f a, V2f b, V2f c) const {
    const V2f p = uv(a), q = uv(b), r = uv(c);
    return maxima.may_reach(V2f(std::min({p.x, q.x, r.x}), std::min({p.y, q.y, r.y})),
                            V2f(std::max({p.x, q.x, r.x}), std::max({p.y, q.y, r.y})), least);
  }

  void visit(V2f a, V2f b, V2f c, int halvings) {
    if (holds(part, a) && holds(part, b) && holds(part, c)) return;
    if (!may_hide(a, b, c)) return;
    if (halvings == 0) {
      extend(part, a);
      extend(part, b);
      extend(part, c);
      return;
    }
    const V2f ab = (a + b) * 0.5f, bc = (b + c) * 0.5f, ca = (c + a) * 0.5f;
    visit(a, ab, ca, halvings - 1);
    visit(ab, b, bc, halvings - 1);
    visit(ca, bc, c, halvings - 1);
    visit(ab, bc, ca, halvings - 1);
  }
};

/// What positions are off by at most, of the triangle's size and of coordinates: cuts are rounded,
/// and so are hits.
constexpr float kRoundingOfSize = 1e-5f, kRounding = 4e-7f;

}  // namespace

OpaquePart OpaquePart::nothing() {
  constexpr float kEndless = std::numeric_limits<float>::infinity();
  OpaquePart part;
  part.least.fill(kEndless);
  part.most.fill(-kEndless);
  return part;
}

Box3f part_box(const std::array<V3f, 3>& corners, const OpaquePart& part) {
  ConvexPolygon polygon({0, 0}, {1, 0}, {0, 1});
  for (std::size_t axis = 0; axis < part.least.size(); ++axis) {
    polygon.cut([&](V2f at) { return part.least[axis] - along_axes(at)[axis]; });
    polygon.cut([&](V2f at) { return along_axes(at)[axis] - part.most[axis]; });
  }
  Box3f whole, box;
  for (const V3f& corner : corners) whole.extendBy(corner);
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const V2f at = polygon.corner[i];
    box.extendBy(corners[0] * (1.0f - at.x - at.y) + corners[1] * at.x + corners[2] * at.y);
  }
  if (box.isEmpty()) return whole;  // a part thinner than rounding
  for (int axis = 0; axis < 3; ++axis) {
    const float off = kRoundingOfSize * (whole.max[axis] - whole.min[axis]) +
                      kRounding * std::max(std::fabs(whole.min[axis]), std::fabs(whole.max[axis]));
    box.min[axis] = std::max(whole.min[axis], box.min[axis] - off);
    box.max[axis] = std::min(whole.max[axis], box.max[axis] + off);
  }
  return box;
}

OpaqueParts::OpaqueParts(const Scene& scene, std::span<const TexturedTriangle> textured)
    : scene_(scene) {
  std::vector<int> needed;
  for (const TexturedTriangle& triangle : textured) {
    if (!has_texture(&triangle)) continue;
    const int texture = scene.materials[textured_material(&triangle)].alpha_texture;
    if (needed.empty() || needed.back() != texture) needed.push_back(texture);
  }
  std::sort(needed.begin(), needed.end());
  needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
  textures_.reserve(needed.size());
  for (const int texture : needed)
    textures_.emplace_back(texture, TexelMaxima(scene.textures[texture]));
}

OpaquePart OpaqueParts::find(const TexturedTriangle& triangle) const {
  const TexturedCorners corners = unpack_textured(triangle);
  if (!corners.has_texture) return {};
  const Material& material = scene_.materials[corners.material];
  const auto at =
      std::lower_bound(textures_.begin(), textures_.end(), material.alpha_texture,
                       [](const auto& entry, int texture) { return entry.first < texture; });
  Search search{at->second, corners, least_texel(material, corners.alpha)};
  search.visit({0, 0}, {1, 0}, {0, 1}, kHalvings);
  return search.part;
}

}  // namespace dapple
