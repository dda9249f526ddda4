#include "bake/texture/uv_overlap.hpp"

#include <Imath/ImathBox.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <unordered_map>

#include "bake/texture/texel_cover.hpp"
#include "bake/texture/texture_layout.hpp"
#include "dapple/error.hpp"
#include "render/option_check.hpp"
#include "scene/check/scene_check.hpp"

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

/// `size`, or a half of it, a quarter and so on where triangles are so many and so large that their
/// texels would take seconds: all cards of a forest may show the same texture.
std::uint32_t affordable_size(const std::vector<std::vector<V2f>>& corners, std::uint32_t size) {
  constexpr double kMostTexels = 1 << 28;  // half a second
  constexpr std::uint32_t kLeastSize = 8;
  double area = 0;  // of the rectangles around triangles, in textures
  for (const std::vector<V2f>& uvs : corners)
    for (std::size_t i = 0; i < uvs.size(); i += 3) {
      Imath::Box2f box;
      for (std::size_t k = 0; k < 3; ++k) box.extendBy(uvs[i + k]);
      area += double{box.size().x} * double{box.size().y};
    }
  while (size >= 2 * kLeastSize && area * size * size > kMostTexels) size /= 2;
  return size;
}

/// The triangles at the centres of texels, mesh after mesh.
class TexelUse {
 public:
  explicit TexelUse(std::uint32_t size) : size_(size), last_(std::size_t{size} * size) {}

  /// A triangle of mesh number `mesh`: that of the triangle before, or a later one.
  void add(const V2f* uv, std::uint32_t mesh) {
    bool has_centre = false;
    visit_centres(uv, size_, [&](std::uint32_t x, std::uint32_t y) {
      has_centre = true;
      std::uint32_t& last = last_[std::size_t{y} * size_ + x];
      if (last != 0) last |= (last & kMesh) == mesh + 1 ? kWithin : kAmong;
      last = (last & ~kMesh) | (mesh + 1);
    });
    if (!has_centre) add_small(uv, mesh);
  }

  [[nodiscard]] UvOverlap overlap() {
    for (const auto& [texel, small] : small_)
      if (small.area > kFullTexel)
        last_[texel] |= (small.within ? kWithin : 0) | (small.first != small.last ? kAmong : 0);
    small_.clear();
    std::size_t covered = 0, several = 0, within = 0, among = 0;
    for (const std::uint32_t last : last_) {
      covered += last != 0 ? 1 : 0;
      several += (last & ~kMesh) != 0 ? 1 : 0;
      within += (last & kWithin) != 0 ? 1 : 0;
      among += (last & kAmong) != 0 ? 1 : 0;
    }
    const auto share = [&](std::size_t texels) {
      return covered > 0 ? static_cast<double>(texels) / static_cast<double>(covered) : 0.0;
    };
    return {share(several), share(within), share(among)};
  }

 private:
  static constexpr std::uint32_t kWithin = 1u << 31, kAmong = 1u << 30, kMesh = kAmong - 1;

  /// Triangles without a texel's centre, of one texel.
  struct SmallTriangles {
    double area = 0, area_of_last = 0;  ///< of all; of the last mesh
    std::uint32_t first = 0, last = 0;  ///< meshes
    bool within = false;                ///< those of one mesh are more than a texel
  };

  /// Adds the area in the texel of the triangle's middle.
  void add_small(const V2f* uv, std::uint32_t mesh) {
    const V2f middle = (uv[0] + uv[1] + uv[2]) * (static_cast<float>(size_) / 3);
    const auto texel = [&](float x) {
      return std::min(static_cast<std::uint32_t>(std::max(x, 0.0f)), size_ - 1);
    };
    const std::uint32_t x = texel(middle.x), y = texel(middle.y);
    const double area = double{clip_to_texel(uv, size_, x, y).area()};
    const auto [at, is_new] = small_.try_emplace(std::size_t{y} * size_ + x);
    SmallTriangles& small = at->second;
    if (is_new) small.first = small.last = mesh;
    if (small.last != mesh) small.area_of_last = 0;
    small.last = mesh;
    small.area += area;
    small.area_of_last += area;
    small.within |= small.area_of_last > kFullTexel;
  }

  std::uint32_t size_;
  /// By texel, the mesh of the last triangle and one more, and kWithin and kAmong as they apply; 0:
  /// no triangle.
  std::vector<std::uint32_t> last_;
  std::unordered_map<std::size_t, SmallTriangles> small_;
};

}  // namespace

UvOverlap find_overlap(const Scene& scene, const std::vector<std::vector<V2f>>& uvs,
                       std::uint32_t size, BakePlacement placement) {
  std::vector<std::vector<V2f>> corners(scene.meshes.size());
  const std::vector<bool> textured = textured_meshes(scene, placement);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (!textured[m]) continue;
    for (const std::uint32_t vertex : scene.meshes[m].indices) {
      const std::optional<V2f> p = texture_point(uvs.at(m).at(vertex));
      if (!p) return {std::numeric_limits<double>::infinity(), 0, 0};
      corners[m].push_back(*p);
    }
  }
  return find_overlap(corners, size);
}

UvOverlap find_overlap(const std::vector<std::vector<V2f>>& corners, std::uint32_t size) {
  TexelUse use(affordable_size(corners, size));
  for (std::uint32_t m = 0; m < corners.size(); ++m)
    for (std::size_t i = 0; i < corners[m].size(); i += 3) use.add(&corners[m][i], m);
  return use.overlap();
}

double uv_overlap(const Scene& scene, const std::vector<std::vector<V2f>>& uvs, std::uint32_t size,
                  BakePlacement placement) {
  check_geometry(scene);
  check_range("uv_overlap: size", double{1.0 * size}, 1, 16384);
  const std::vector<bool> textured = textured_meshes(scene, placement);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (textured[m] && (m >= uvs.size() || uvs[m].size() != scene.meshes[m].positions.size()))
      throw Error(
          ErrorKind::usage,
          fmt::format("uv_overlap: mesh {} has {} vertices and {} texture coordinates", m,
                      scene.meshes[m].positions.size(), m < uvs.size() ? uvs[m].size() : 0));
  return find_overlap(scene, uvs, size, placement).share;
}

}  // namespace dapple
