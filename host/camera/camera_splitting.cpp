#include "camera/camera_splitting.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "bvh/opacity/triangle_opacity.hpp"

namespace dapple {
namespace {

/// Four samples share a camera ray when more than kPartOfFour of all surfaces have at most the
/// opacity kOpacityOfFour; two when more than kPartOfTwo have at most kOpacityOfTwo (experiment
/// 401). For averages of several texels kOpacityOfTwo is the limit of both, as averages take all
/// values.
constexpr float kOpacityOfFour = 0.3f, kOpacityOfTwo = 0.85f;
constexpr double kPartOfFour = 0.25, kPartOfTwo = 0.1;

/// About how many mip footprints of a texture are examined along each axis, and at most how many
/// texels of each footprint.
constexpr int kFootprints = 64, kTexels = 4;

/// Textures are averaged here for this number of samples a pixel, not for the picture's own: a
/// render that is resumed with more samples must keep its splitting factor.
constexpr int kSamples = 16;

float mean_vertex_alpha(const Mesh& mesh) {
  if (mesh.vertex_alpha.empty()) return 1.0f;
  return std::accumulate(mesh.vertex_alpha.begin(), mesh.vertex_alpha.end(), 0.0f) /
         static_cast<float>(mesh.vertex_alpha.size());
}

/// Numbers of surfaces with an opacity above 0: all of them, and those that suit two and four
/// samples a camera ray.
struct Counts {
  double all = 0, for_two = 0, for_four = 0;

  void add(const Counts& counts, double times) {
    all += times * counts.all;
    for_two += times * counts.for_two;
    for_four += times * counts.for_four;
  }
};

/// Counts one surface of that opacity. Four samples suit opacities up to `of_four`.
Counts count_opacity(float opacity, float of_four) {
  if (opacity <= 0) return {};
  return {1, opacity <= kOpacityOfTwo ? 1.0 : 0.0, opacity <= of_four ? 1.0 : 0.0};
}

/// A material's factor of alpha, and its cutoff, below 0 for none: arguments of thresholded().
struct Factors {
  float factor, cutoff;
};

/// The mean opacity of the mip footprint of `side` x `side` texels from (x, y) on, from at most
/// kTexels x kTexels of them.
float footprint_opacity(const Texture& texture, Factors factors, std::uint32_t x, std::uint32_t y,
                        std::uint32_t side) {
  const std::uint32_t width = std::min(side, texture.width - x);
  const std::uint32_t height = std::min(side, texture.height - y);
  const std::uint32_t columns = std::min<std::uint32_t>(width, kTexels);
  const std::uint32_t rows = std::min<std::uint32_t>(height, kTexels);
  float sum = 0;
  for (std::uint32_t j = 0; j < rows; ++j) {
    const std::size_t row = y + std::size_t{j} * height / rows;
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::size_t column = x + std::size_t{i} * width / columns;
      const float alpha = static_cast<float>(texture.alpha[row * texture.width + column]) / 255;
      sum += thresholded(alpha * factors.factor, factors.cutoff);
    }
  }
  return sum / static_cast<float>(rows * columns);
}

/// Counts one surface: the mean over its texture's mip footprints with an opacity above 0.
Counts count_footprints(const Texture& texture, Factors factors, std::uint32_t side) {
  const std::uint32_t across = side * std::max(1u, texture.width / side / kFootprints);
  const std::uint32_t down = side * std::max(1u, texture.height / side / kFootprints);
  const float of_four = side > 1 ? kOpacityOfTwo : kOpacityOfFour;
  Counts footprints;
  for (std::uint32_t y = 0; y < texture.height; y += down)
    for (std::uint32_t x = 0; x < texture.width; x += across)
      footprints.add(count_opacity(footprint_opacity(texture, factors, x, y, side), of_four), 1);
  Counts one;
  if (footprints.all > 0) one.add(footprints, 1 / footprints.all);
  return one;
}

/// Triangles of a mesh that share a material.
struct Part {
  const Material* material = nullptr;
  double triangles = 0;
  float texel_size = 0;            ///< object space, of the first triangle that has a texel size
  std::map<int, Counts> counts{};  ///< of one triangle, by mip level
};

using Parts = std::map<std::uint32_t, Part>;  ///< by material

Parts parts_by_material(const Scene& scene, const Mesh& mesh) {
  Parts parts;
  Part* part = nullptr;
  bool textured = false;
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    // Most triangles have the same material as the triangle before.
    if (i == 0 || mesh.materials[i] != mesh.materials[i - 1]) {
      part = &parts[mesh.materials[i]];
      part->material = &scene.materials[mesh.materials[i]];
      textured = has_texture(*part->material, mesh);
    }
    ++part->triangles;
    if (textured && part->texel_size == 0)
      part->texel_size = texel_size(scene, mesh, static_cast<std::uint32_t>(i));
  }
  return parts;
}

Counts count_part(const Scene& scene, const Mesh& mesh, const Part& part, int level) {
  const Material& material = *part.material;
  if (material.alpha_mode == AlphaMode::opaque) return {1, 0, 0};
  const float vertex_alpha = material.uses_vertex_alpha ? mean_vertex_alpha(mesh) : 1.0f;
  const Factors factors{material.alpha * vertex_alpha, cutoff_of(material)};
  if (!has_texture(material, mesh))
    return count_opacity(thresholded(factors.factor, factors.cutoff), kOpacityOfFour);
  return count_footprints(scene.textures[material.alpha_texture], factors, 1u << level);
}

/// The mip level whose texels are as wide as the area that a camera ray averages of the texture.
int seen_level(const Part& part, const Instance& instance, const Mesh& mesh, const View& view,
               float spread) {
  if (part.texel_size == 0 || spread == 0) return 0;
  const float scale = std::cbrt(std::fabs(instance.to_world.determinant()));
  const float width = std::sqrt(spread) * pixel_width(view, mesh.positions[0] * instance.to_world);
  const float level = std::log2(width / (part.texel_size * scale));
  return std::isfinite(level) ? static_cast<int>(std::clamp(level, 0.0f, 15.0f)) : 0;
}

Counts count_surfaces(const Scene& scene, const View& view, float spread) {
  std::vector<std::optional<Parts>> parts(scene.meshes.size());
  Counts counts;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    auto& of_mesh = parts[instance.mesh];
    if (!of_mesh) of_mesh = parts_by_material(scene, mesh);
    for (auto& [material, part] : *of_mesh) {
      const int level = seen_level(part, instance, mesh, view, spread);
      const auto [at, is_new] = part.counts.try_emplace(level);
      if (is_new) at->second = count_part(scene, mesh, part, level);
      counts.add(at->second, part.triangles);
    }
  }
  return counts;
}

/// Maximum number of samples a pixel, whether they share camera rays or not: kMaxRaysOfPixel.
double max_samples(const RenderOptions& options) {
  return double{kMaxRaysOfPixel} / std::max(options.ao_rays, options.light_rays);
}

}  // namespace

int choose_camera_splitting(const RenderOptions& options, const Scene& scene, const View& view) {
  if (options.camera_splitting > 0) return options.camera_splitting;
  RenderOptions with_taps = options;
  with_taps.camera_splitting = DAPPLE_MAX_CAMERA_SPLITTING;
  const Counts counts = count_surfaces(scene, view, texel_footprint(with_taps, kSamples).spread);
  int factor = counts.for_four > kPartOfFour * counts.all ? 4
               : counts.for_two > kPartOfTwo * counts.all ? 2
                                                          : 1;
  const double rays = is_adaptive(options) ? options.max_spp : options.spp;
  while (factor > 1 && rays * factor > max_samples(options)) factor /= 2;
  return factor;
}

RenderOptions by_sample(const RenderOptions& options) {
  RenderOptions out = options;
  out.spp *= out.camera_splitting;
  out.max_spp *= out.camera_splitting;
  out.footprint_spp = footprint_samples(options);
  out.footprint_ao_rays = footprint_ao_rays(options);
  out.ao_rays = (options.ao_rays + out.camera_splitting - 1) / out.camera_splitting;
  return out;
}

}  // namespace dapple
