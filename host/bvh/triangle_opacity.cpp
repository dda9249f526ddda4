#include "bvh/triangle_opacity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "dapple/error.hpp"

namespace dapple {
namespace {

int wrap(int cell, int size, Wrap mode) {
  if (mode == Wrap::clamp) return std::clamp(cell, 0, size - 1);
  const int period = mode == Wrap::mirror ? 2 * size : size;
  int r = cell % period;
  if (r < 0) r += period;
  return r < size ? r : period - 1 - r;
}

/// A texture coordinate brought near [0,1), so that integers can hold its texel.
float folded_coordinate(float u, Wrap mode) {
  return mode == Wrap::clamp ? std::clamp(u, -1.0f, 2.0f) : u - 2.0f * std::floor(0.5f * u);
}

std::array<float, 3> vertex_alphas(const Material& material, const Mesh& mesh,
                                   std::uint32_t triangle) {
  std::array<float, 3> alpha{1, 1, 1};
  if (material.uses_vertex_alpha && !mesh.vertex_alpha.empty()) {
    for (int corner = 0; corner < 3; ++corner) {
      alpha[corner] = mesh.vertex_alpha[mesh.indices[3 * std::size_t{triangle} + corner]];
    }
  }
  return alpha;
}

void check_material(const Scene& scene, std::uint32_t material) {
  if (material < DAPPLE_MOST_TEXTURED_MATERIALS) return;
  throw Error(ErrorKind::failed,
              fmt::format("{}: the opacity of material {} ({}) varies over triangles, which only "
                          "the first {} materials' may; merge materials that are equal",
                          scene.source, material, scene.materials[material].name,
                          DAPPLE_MOST_TEXTURED_MATERIALS));
}

}  // namespace

bool has_texture(const Material& material, const Mesh& mesh) {
  return material.alpha_texture >= 0 && !mesh.uvs.empty();
}

float thresholded(float alpha, float cutoff) {
  if (cutoff < 0.0f) return std::clamp(alpha, 0.0f, 1.0f);
  return alpha >= cutoff ? 1.0f : 0.0f;
}

float cutoff_of(const Material& material) {
  return material.alpha_mode == AlphaMode::mask ? std::max(material.alpha_cutoff, 0.0f) : -1.0f;
}

std::optional<float> uniform_opacity(const Scene& scene, const Mesh& mesh, std::uint32_t triangle) {
  const Material& material = scene.materials[mesh.materials[triangle]];
  if (material.alpha_mode == AlphaMode::opaque) return 1.0f;
  if (has_texture(material, mesh)) return std::nullopt;
  auto alpha = vertex_alphas(material, mesh, triangle);
  for (float& corner : alpha) corner *= material.alpha;
  const float cutoff = cutoff_of(material);
  const float first = thresholded(alpha[0], cutoff);
  const bool same_alpha = alpha[0] == alpha[1] && alpha[1] == alpha[2];
  const bool same_side = cutoff >= 0.0f && first == thresholded(alpha[1], cutoff) &&
                         first == thresholded(alpha[2], cutoff);
  if (same_alpha || same_side) return first;
  return std::nullopt;
}

float segment_opacity(const Scene& scene, const Mesh& mesh, std::uint32_t segment) {
  const Material& material = scene.materials[mesh.materials[segment]];
  if (material.alpha_mode == AlphaMode::opaque) return 1.0f;
  float alpha = material.alpha;
  if (material.uses_vertex_alpha && !mesh.vertex_alpha.empty()) {
    const std::uint32_t* at = &mesh.indices[2 * std::size_t{segment}];
    alpha *= 0.5f * (mesh.vertex_alpha[at[0]] + mesh.vertex_alpha[at[1]]);
  }
  return thresholded(alpha, cutoff_of(material));
}

TexturedTriangle textured_triangle(const Scene& scene, const Mesh& mesh, std::uint32_t triangle) {
  const Material& material = scene.materials[mesh.materials[triangle]];
  TexturedCorners corners;
  corners.material = mesh.materials[triangle];
  check_material(scene, corners.material);
  corners.alpha = vertex_alphas(material, mesh, triangle);
  corners.has_texture = has_texture(material, mesh);
  if (!corners.has_texture) return pack_textured(corners, Wrap::repeat, Wrap::repeat);
  for (int corner = 0; corner < 3; ++corner) {
    corners.uv[corner] = mesh.uvs[mesh.indices[3 * std::size_t{triangle} + corner]];
  }
  const Texture& texture = scene.textures[material.alpha_texture];
  return pack_textured(corners, texture.wrap_s, texture.wrap_t);
}

OpacityPyramid::OpacityPyramid(const Texture& texture, float factor, float cutoff)
    : size_(static_cast<float>(texture.width), static_cast<float>(texture.height)),
      wrap_s_(texture.wrap_s),
      wrap_t_(texture.wrap_t) {
  Level base{static_cast<int>(texture.width), static_cast<int>(texture.height), {}};
  base.opacity.resize(texture.alpha.size());
  std::transform(texture.alpha.begin(), texture.alpha.end(), base.opacity.begin(),
                 [&](std::uint8_t a) {
                   return thresholded(static_cast<float>(a) * (1.0f / 255.0f) * factor, cutoff);
                 });
  levels_.push_back(std::move(base));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
    coarse.opacity.resize(static_cast<std::size_t>(coarse.width) * coarse.height);
    // Odd sizes: the last column or row is shared out by area, so that means are kept.
    const float sx = static_cast<float>(fine.width) / static_cast<float>(coarse.width);
    const float sy = static_cast<float>(fine.height) / static_cast<float>(coarse.height);
    for (int y = 0; y < coarse.height; ++y) {
      for (int x = 0; x < coarse.width; ++x) {
        const float x0 = static_cast<float>(x) * sx, x1 = x0 + sx, y0 = static_cast<float>(y) * sy,
                    y1 = y0 + sy;
        float sum = 0.0f, weight = 0.0f;
        for (int j = static_cast<int>(y0); j < fine.height && static_cast<float>(j) < y1; ++j) {
          const float wy =
              std::min(y1, static_cast<float>(j + 1)) - std::max(y0, static_cast<float>(j));
          for (int i = static_cast<int>(x0); i < fine.width && static_cast<float>(i) < x1; ++i) {
            const float w = wy * (std::min(x1, static_cast<float>(i + 1)) -
                                  std::max(x0, static_cast<float>(i)));
            sum += w * fine.opacity[static_cast<std::size_t>(j) * fine.width + i];
            weight += w;
          }
        }
        coarse.opacity[static_cast<std::size_t>(y) * coarse.width + x] = sum / weight;
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

float OpacityPyramid::bilinear(const Level& level, V2f uv) const {
  const float x = uv.x * static_cast<float>(level.width) - 0.5f;
  const float y = uv.y * static_cast<float>(level.height) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const float fx = x - left, fy = y - top;
  const auto at = [&](float i, float j) {
    const int column = wrap(static_cast<int>(i), level.width, wrap_s_);
    const int row = wrap(static_cast<int>(j), level.height, wrap_t_);
    return level.opacity[static_cast<std::size_t>(row) * level.width + column];
  };
  const float upper = at(left, top) * (1 - fx) + at(left + 1, top) * fx;
  const float lower = at(left, top + 1) * (1 - fx) + at(left + 1, top + 1) * fx;
  return upper * (1 - fy) + lower * fy;
}

float OpacityPyramid::mean(V2f uv, float width_texels) const {
  const V2f at(folded_coordinate(uv.x, wrap_s_), folded_coordinate(uv.y, wrap_t_));
  const float level = std::clamp(std::log2(std::max(width_texels, 1.0f)), 0.0f,
                                 static_cast<float>(levels_.size() - 1));
  const auto fine = static_cast<std::size_t>(level);
  const auto coarse = std::min(fine + 1, levels_.size() - 1);
  const float blend = level - static_cast<float>(fine);
  return bilinear(levels_[fine], at) * (1 - blend) + bilinear(levels_[coarse], at) * blend;
}

TextureIntegrals::Key TextureIntegrals::key_of(const TexturedCorners& corners) const {
  // A blended texture's mean is linear in the factor, which is applied later; a cut-out's
  // is not, so it gets a pyramid for each factor (rounded, where vertices differ).
  const Material& material = materials_[corners.material];
  const float cutoff = cutoff_of(material);
  if (cutoff < 0.0f) return {material.alpha_texture, 1.0f, -1.0f};
  const float factor =
      material.alpha * (corners.alpha[0] + corners.alpha[1] + corners.alpha[2]) / 3.0f;
  return {material.alpha_texture, std::round(factor * 64.0f) / 64.0f, cutoff};
}

TextureIntegrals::TextureIntegrals(const Scene& scene, std::span<const TexturedTriangle> textured)
    : materials_(scene.materials) {
  std::vector<Key> keys;
  for (const TexturedTriangle& triangle : textured) {
    const TexturedCorners corners = unpack_textured(triangle);
    if (!corners.has_texture) continue;
    const Key key = key_of(corners);
    if (keys.empty() || keys.back() != key) keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  pyramids_.reserve(keys.size());
  for (const Key& key : keys) {
    pyramids_.emplace_back(key,
                           OpacityPyramid(scene.textures[key.texture], key.factor, key.cutoff));
  }
}

const OpacityPyramid* TextureIntegrals::find(const Key& key) const {
  const auto at = std::lower_bound(pyramids_.begin(), pyramids_.end(), key,
                                   [](const auto& entry, const Key& k) { return entry.first < k; });
  return at != pyramids_.end() && at->first == key ? &at->second : nullptr;
}

float TextureIntegrals::mean(const TexturedTriangle& triangle, float u, float v,
                             float share) const {
  const TexturedCorners corners = unpack_textured(triangle);
  const float w = 1.0f - u - v;
  const float cutoff = cutoff_of(materials_[corners.material]);
  const float alpha = materials_[corners.material].alpha *
                      (corners.alpha[0] * w + corners.alpha[1] * u + corners.alpha[2] * v);
  const OpacityPyramid* pyramid = corners.has_texture ? find(key_of(corners)) : nullptr;
  if (!pyramid) return thresholded(alpha, cutoff);
  const auto& [a, b, c] = corners.uv;
  const V2f e1 = (b - a) * pyramid->size(), e2 = (c - a) * pyramid->size();
  const float texels = 0.5f * std::fabs(e1.x * e2.y - e1.y * e2.x) * share;
  const float mean = pyramid->mean(a * w + b * u + c * v, std::sqrt(texels));
  return cutoff < 0.0f ? std::clamp(mean * alpha, 0.0f, 1.0f) : mean;
}

}  // namespace dapple
