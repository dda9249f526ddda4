#include "wavefront/depths.hpp"

#include <algorithm>
#include <numeric>

#include "bvh/triangle_opacity.hpp"

namespace dapple {
namespace {

/// Opacities up to which that part of all surfaces must be for so many samples a camera ray
/// (figures in the README). More than suit cost up to a fifth of the time, fewer up to half of it.
constexpr float kOpacityOfFour = 0.3f, kOpacityOfTwo = 0.7f;
constexpr double kPart = 0.25;

/// Texels of a texture that are looked at, spread evenly.
constexpr std::size_t kTexels = 4096;

float mean_vertex_alpha(const Mesh& mesh) {
  if (mesh.vertex_alpha.empty()) return 1.0f;
  return std::accumulate(mesh.vertex_alpha.begin(), mesh.vertex_alpha.end(), 0.0f) /
         static_cast<float>(mesh.vertex_alpha.size());
}

/// Of surfaces that stop anything: all, and those that two and four samples suit.
struct Counts {
  double all = 0, for_two = 0, for_four = 0;

  void add(const Counts& counts, double times) {
    all += times * counts.all;
    for_two += times * counts.for_two;
    for_four += times * counts.for_four;
  }
};

/// One surface of the material: of a texture, all its texels together.
Counts count_opacities(const Scene& scene, const Mesh& mesh, const Material& material,
                       float vertex_alpha) {
  if (material.alpha_mode == AlphaMode::opaque) return {1, 0, 0};
  Counts texels;
  const float factor = material.alpha * (material.uses_vertex_alpha ? vertex_alpha : 1.0f);
  const auto count = [&](float alpha) {
    const float opacity = thresholded(alpha * factor, cutoff_of(material));
    if (opacity <= 0) return;
    texels.add({1, opacity <= kOpacityOfTwo ? 1.0 : 0.0, opacity <= kOpacityOfFour ? 1.0 : 0.0}, 1);
  };
  if (!has_texture(material, mesh)) {
    count(1);
  } else {
    const std::vector<std::uint8_t>& alpha = scene.textures[material.alpha_texture].alpha;
    const std::size_t step = std::max<std::size_t>(1, alpha.size() / kTexels);
    for (std::size_t at = 0; at < alpha.size(); at += step)
      count(static_cast<float>(alpha[at]) / 255);
  }
  Counts one;
  if (texels.all > 0) one.add(texels, 1 / texels.all);
  return one;
}

Counts count_surfaces(const Scene& scene) {
  std::vector<double> placed(scene.meshes.size(), 0.0);
  for (const Instance& instance : scene.instances) placed[instance.mesh] += 1;
  Counts counts;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (placed[m] == 0) continue;
    const Mesh& mesh = scene.meshes[m];
    std::vector<std::size_t> of_material(scene.materials.size(), 0);
    for (const std::uint32_t material : mesh.materials) ++of_material[material];
    const float vertex_alpha = mean_vertex_alpha(mesh);
    for (std::size_t i = 0; i < of_material.size(); ++i) {
      if (of_material[i] == 0) continue;
      counts.add(count_opacities(scene, mesh, scene.materials[i], vertex_alpha),
                 placed[m] * static_cast<double>(of_material[i]));
    }
  }
  return counts;
}

/// Samples of a pixel that it may have, whatever of them share a camera ray.
double most_samples(const RenderOptions& options) {
  return double{kMostRaysOfPixel} / std::max(options.ao_rays, options.light_rays);
}

}  // namespace

int choose_depths(const RenderOptions& options, const Scene& scene) {
  if (options.depths > 0) return options.depths;
  const Counts counts = count_surfaces(scene);
  const double enough = kPart * counts.all;
  int depths = counts.for_four > enough ? 4 : counts.for_two > enough ? 2 : 1;
  const double rays = is_adaptive(options) ? options.max_spp : options.spp;
  while (depths > 1 && rays * depths > most_samples(options)) depths /= 2;
  return depths;
}

RenderOptions by_sample(const RenderOptions& options) {
  RenderOptions out = options;
  out.spp *= out.depths;
  out.max_spp *= out.depths;
  out.footprint_spp = footprint_samples(options);
  out.footprint_ao_rays = footprint_ao_rays(options);
  out.ao_rays = (options.ao_rays + out.depths - 1) / out.depths;
  return out;
}

}  // namespace dapple
