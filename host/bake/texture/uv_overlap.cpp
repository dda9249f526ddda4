// How much of a texture several triangles share: see uv_overlap() in dapple/bake.hpp.
#include <algorithm>
#include <limits>
#include <unordered_map>

#include "bake/texture/texel_cover.hpp"
#include "bake/texture/texture_layout.hpp"

namespace dapple {
namespace {

/// Clipped areas of triangles that lie side by side in a texel add up to 1, and their rounding.
constexpr double kFullTexel = 1.01;

/// Each texel of a size x size texture whose centre lies in a triangle, once for each triangle.
template <class Visit>
void visit_centres(const V2f* uv, std::uint32_t size, Visit visit) {
  const auto scale = static_cast<float>(size);
  const V2f a = uv[0] * scale, b = uv[1] * scale, c = uv[2] * scale;
  const float turn = (b - a).cross(c - a) < 0 ? -1.0f : 1.0f;
  const auto first = [](float x) { return static_cast<std::uint32_t>(std::max(0.0f, x - 0.5f)); };
  const auto last = [&](float x) {
    return static_cast<std::uint32_t>(std::clamp(x + 0.5f, 0.0f, scale - 1));
  };
  for (std::uint32_t y = first(std::min({a.y, b.y, c.y})); y <= last(std::max({a.y, b.y, c.y}));
       ++y) {
    for (std::uint32_t x = first(std::min({a.x, b.x, c.x})); x <= last(std::max({a.x, b.x, c.x}));
         ++x) {
      const V2f p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const bool inside = turn * (b - a).cross(p - a) > 0 && turn * (c - b).cross(p - b) > 0 &&
                          turn * (a - c).cross(p - c) > 0;
      if (inside) visit(x, y);
    }
  }
}

/// Counts the triangles at the centres of texels.
class TexelCounts {
 public:
  explicit TexelCounts(std::uint32_t size) : size_(size), count_(std::size_t{size} * size) {}

  void add(const V2f* uv) {
    bool has_centre = false;
    visit_centres(uv, size_, [&](std::uint32_t x, std::uint32_t y) {
      has_centre = true;
      add_at(std::size_t{y} * size_ + x);
    });
    if (!has_centre) add_small(uv);
  }

  /// The share of the covered texels that several triangles cover.
  [[nodiscard]] double share() {
    for (const auto& [texel, area] : small_)
      for (int i = 0; i < 2 && area > kFullTexel; ++i) add_at(texel);
    small_.clear();
    return covered_ > 0 ? static_cast<double>(several_) / static_cast<double>(covered_) : 0.0;
  }

 private:
  void add_at(std::size_t texel) {
    if (count_[texel] == 0) ++covered_;
    if (count_[texel] == 1) ++several_;
    count_[texel] = static_cast<std::uint8_t>(std::min(2, count_[texel] + 1));
  }

  /// Of a triangle without a texel's centre the area in the texel of its middle.
  void add_small(const V2f* uv) {
    const V2f middle = (uv[0] + uv[1] + uv[2]) * (static_cast<float>(size_) / 3);
    const auto texel = [&](float x) {
      return std::min(static_cast<std::uint32_t>(std::max(x, 0.0f)), size_ - 1);
    };
    const std::uint32_t x = texel(middle.x), y = texel(middle.y);
    small_[std::size_t{y} * size_ + x] += double{clip_to_texel(uv, size_, x, y).area()};
  }

  std::uint32_t size_;
  std::vector<std::uint8_t> count_;  ///< by texel, at most 2
  std::unordered_map<std::size_t, double> small_;
  std::size_t covered_ = 0, several_ = 0;
};

}  // namespace

double uv_overlap(const Scene& scene, const std::vector<std::vector<V2f>>& uvs, std::uint32_t size,
                  BakeInstances placement) {
  TexelCounts counts(size);
  const std::vector<bool> textured = textured_meshes(scene, placement);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!textured[m]) continue;
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      V2f uv[3];
      for (std::size_t k = 0; k < 3; ++k) {
        uv[k] = uvs.at(m).at(mesh.indices[3 * t + k]);
        const bool inside = uv[k].x >= 0 && uv[k].x <= 1 && uv[k].y >= 0 && uv[k].y <= 1;
        if (!inside) return std::numeric_limits<double>::infinity();
      }
      counts.add(uv);
    }
  }
  return counts.share();
}

}  // namespace dapple
