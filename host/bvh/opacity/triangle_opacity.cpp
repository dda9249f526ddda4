#include "bvh/opacity/triangle_opacity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "dapple/error.hpp"

namespace dapple {
namespace {

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
  if (material < DAPPLE_MAX_TEXTURED_MATERIALS) return;
  throw Error(ErrorKind::failed,
              fmt::format("{}: the opacity of material {} ({}) varies over triangles, which only "
                          "the first {} materials' may; merge materials that are equal",
                          scene.source, material, scene.materials[material].name,
                          DAPPLE_MAX_TEXTURED_MATERIALS));
}

}  // namespace

void check_textured_count(const Scene& scene, std::size_t count) {
  if (count < DAPPLE_MAX_TEXTURED_TRIANGLES) return;
  throw Error(
      ErrorKind::failed,
      fmt::format("{}: the opacity of {} or more triangles varies over them (alpha textures, "
                  "vertex alpha); dapple has room for fewer",
                  scene.source, DAPPLE_MAX_TEXTURED_TRIANGLES));
}

bool has_texture(const Material& material, const Mesh& mesh) {
  return material.alpha_texture >= 0 && !mesh.uvs.empty();
}

float cutoff_of(const Material& material) {
  return material.alpha_mode == AlphaMode::mask ? std::max(material.alpha_cutoff, 0.0f) : -1.0f;
}

float texel_size(const Scene& scene, const Mesh& mesh, std::uint32_t triangle) {
  const Material& material = scene.materials[mesh.materials[triangle]];
  if (!has_texture(material, mesh)) return 0.0f;
  const Texture& texture = scene.textures[material.alpha_texture];
  const V2f size(static_cast<float>(texture.width), static_cast<float>(texture.height));
  const std::uint32_t* at = &mesh.indices[3 * std::size_t{triangle}];
  const V3f edge1 = mesh.positions[at[1]] - mesh.positions[at[0]];
  const V3f edge2 = mesh.positions[at[2]] - mesh.positions[at[0]];
  const V2f across = (mesh.uvs[at[1]] - mesh.uvs[at[0]]) * size;
  const V2f along = (mesh.uvs[at[2]] - mesh.uvs[at[0]]) * size;
  const float texels = std::fabs(across.cross(along));
  return texels > 0 ? std::sqrt(edge1.cross(edge2).length() / texels) : 0.0f;
}

std::optional<float> uniform_opacity(const Scene& scene, const OpaqueTexels& texels,
                                     const Mesh& mesh, std::uint32_t triangle) {
  const Material& material = scene.materials[mesh.materials[triangle]];
  if (material.alpha_mode == AlphaMode::opaque) return 1.0f;
  auto alpha = vertex_alphas(material, mesh, triangle);
  if (has_texture(material, mesh)) {
    // Factors of a masked material's vertices may cut out what its texture does not.
    const bool is_factor_1 = alpha == std::array<float, 3>{1, 1, 1};
    if (material.alpha_mode == AlphaMode::mask && !is_factor_1) return std::nullopt;
    if (!texels.cover(mesh, triangle)) return std::nullopt;
  }
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

TexturedTriangle textured_triangle(const Scene& scene, const Mesh& mesh, std::uint32_t triangle,
                                   bool averaged) {
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
  if (averaged && !is_beyond_border(corners.uv, texture.wrap_s, texture.wrap_t))
    corners.texel_size = texel_size(scene, mesh, triangle);
  return pack_textured(corners, texture.wrap_s, texture.wrap_t);
}

}  // namespace dapple
