#include "rivals/embree/opacity_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dapple::bench {
namespace {

/// With SSE2 std::floor is a function call.
int floor_to_int(float x) {
  const int cell = static_cast<int>(x);
  return cell - (x < static_cast<float>(cell) ? 1 : 0);
}

/// One axis of a lookup: two adjacent texels, and the position between them.
struct Neighbours {
  int first, second;
  float share;
};

/// The texels for a coordinate, without a division. Repeated and mirrored coordinates are mapped to
/// [0,1] first, so that at most one texel is beyond the edge. Mirroring repeats the texel at the
/// edge, as clamping does.
Neighbours neighbours(float coordinate, std::uint32_t size, Wrap wrap, bool nearest) {
  const int n = static_cast<int>(size);
  float u = coordinate;
  if (wrap == Wrap::repeat) {
    u -= static_cast<float>(floor_to_int(u));
  } else if (wrap == Wrap::mirror) {
    u -= 2.0f * static_cast<float>(floor_to_int(0.5f * u));
    u = u > 1.0f ? 2.0f - u : u;
  } else {
    u = std::clamp(u, 0.0f, 1.0f);
  }
  const float x = u * static_cast<float>(size) - (nearest ? 0.0f : 0.5f);
  const int cell = floor_to_int(x);
  const float share = nearest ? 0.0f : x - static_cast<float>(cell);
  if (wrap == Wrap::repeat)
    return {cell < 0 ? cell + n : (cell >= n ? cell - n : cell), cell + 1 < n ? cell + 1 : 0,
            share};
  return {std::clamp(cell, 0, n - 1), std::clamp(cell + 1, 0, n - 1), share};
}

float texture_alpha(const Texture& texture, float u, float v) {
  const Neighbours x = neighbours(u, texture.width, texture.wrap_s, texture.nearest);
  const Neighbours y = neighbours(v, texture.height, texture.wrap_t, texture.nearest);
  const std::uint8_t* top =
      texture.alpha.data() + static_cast<std::size_t>(y.first) * texture.width;
  const std::uint8_t* low =
      texture.alpha.data() + static_cast<std::size_t>(y.second) * texture.width;
  const auto along = [&](const std::uint8_t* row) {
    const float a = row[x.first], b = row[x.second];
    return a + (b - a) * x.share;
  };
  const float upper = along(top), lower = along(low);
  return (upper + (lower - upper) * y.share) * (1.0f / 255.0f);
}

float thresholded(float alpha, float cutoff) {
  if (cutoff >= 0.0f) return alpha >= cutoff ? 1.0f : 0.0f;
  return std::clamp(alpha, 0.0f, 1.0f);
}

float cutoff_of(const Material& material) {
  return material.alpha_mode == AlphaMode::mask ? std::max(0.0f, material.alpha_cutoff) : -1.0f;
}

/// Base colour alpha times vertex alpha at the three corners.
std::array<float, 3> corner_alphas(const Material& material, const Mesh& mesh,
                                   std::size_t triangle) {
  std::array<float, 3> alphas{};
  alphas.fill(material.alpha);
  if (!material.uses_vertex_alpha || mesh.vertex_alpha.empty()) return alphas;
  for (std::size_t k = 0; k < 3; ++k)
    alphas[k] *= mesh.vertex_alpha[mesh.indices[3 * triangle + k]];
  return alphas;
}

}  // namespace

std::optional<float> constant_opacity(const Scene& scene, const Mesh& mesh, std::size_t triangle) {
  const Material& material = scene.materials[mesh.materials[triangle]];
  if (material.alpha_mode == AlphaMode::opaque) return 1.0f;
  if (material.alpha_texture >= 0 && !mesh.uvs.empty()) return std::nullopt;
  const auto alphas = corner_alphas(material, mesh, triangle);
  if (alphas[0] != alphas[1] || alphas[0] != alphas[2]) return std::nullopt;
  return thresholded(alphas[0], cutoff_of(material));
}

float segment_opacity(const Scene& scene, const Mesh& mesh, std::size_t segment) {
  const Material& material = scene.materials[mesh.materials[segment]];
  if (material.alpha_mode == AlphaMode::opaque) return 1.0f;
  float alpha = material.alpha;
  if (material.uses_vertex_alpha && !mesh.vertex_alpha.empty()) {
    alpha *= 0.5f * (mesh.vertex_alpha[mesh.indices[2 * segment]] +
                     mesh.vertex_alpha[mesh.indices[2 * segment + 1]]);
  }
  return thresholded(alpha, cutoff_of(material));
}

void OpacityTable::append(const Scene& scene, const Mesh& mesh, std::size_t triangle) {
  if (const auto constant = constant_opacity(scene, mesh, triangle)) {
    codes_.push_back(*constant);
    return;
  }
  const Material& material = scene.materials[mesh.materials[triangle]];
  Varying varying{};
  const auto alphas = corner_alphas(material, mesh, triangle);
  std::copy(alphas.begin(), alphas.end(), varying.alpha);
  varying.cutoff = cutoff_of(material);
  if (material.alpha_texture >= 0 && !mesh.uvs.empty()) {
    varying.texture = &scene.textures[static_cast<std::size_t>(material.alpha_texture)];
    for (std::size_t k = 0; k < 3; ++k) {
      const V2f uv = mesh.uvs[mesh.indices[3 * triangle + k]];
      varying.uv[k][0] = uv.x;
      varying.uv[k][1] = uv.y;
    }
  }
  codes_.push_back(std::bit_cast<float>(kVarying | static_cast<std::uint32_t>(varying_.size())));
  varying_.push_back(varying);
}

float OpacityTable::varying(std::uint32_t index, float u, float v) const {
  const Varying& t = varying_[index];
  const float w = 1.0f - u - v;
  float alpha = t.alpha[0] * w + t.alpha[1] * u + t.alpha[2] * v;
  if (t.texture) {
    alpha *= texture_alpha(*t.texture, t.uv[0][0] * w + t.uv[1][0] * u + t.uv[2][0] * v,
                           t.uv[0][1] * w + t.uv[1][1] * u + t.uv[2][1] * v);
  }
  return thresholded(alpha, t.cutoff);
}

std::size_t OpacityTable::bytes() const {
  return codes_.size() * sizeof(float) + varying_.size() * sizeof(Varying);
}

}  // namespace dapple::bench
