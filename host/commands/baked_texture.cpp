#include "commands/baked_texture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bake/texture/texture_layout.hpp"
#include "dapple/film.hpp"
#include "film/png.hpp"

namespace dapple {
namespace {

/// Overlaps up to this share are roundings at the borders of neighbouring triangles.
constexpr double kMaxOverlap = 1e-3;

/// Of a larger share of the surface without area in the texture, the values would be lost.
constexpr double kMaxWithoutTexels = 0.01;

/// Why texture coordinates cannot be used; empty: they can.
std::string fault_of(const Scene& scene, const std::vector<std::vector<V2f>>& uvs,
                     const BakeOptions& options) {
  const double overlap = uv_overlap(scene, uvs, options.texture_size, options.placement);
  if (std::isinf(overlap)) return "leaves the texture";
  if (overlap > kMaxOverlap)
    return fmt::format("overlaps itself in {:.1f} % of its texels", 100 * overlap);
  const double without = share_without_texels(scene, uvs, options.texture_size, options.placement);
  if (without > kMaxWithoutTexels)
    return fmt::format("has no area in the texture for {:.1f} % of the surface", 100 * without);
  return {};
}

/// TEXCOORD_`set` for each mesh and vertex; empty if a primitive has none.
std::vector<std::vector<V2f>> uvs_of_set(const gltf::SourceFile& file, const Scene& scene,
                                         std::uint32_t set) {
  std::vector<std::vector<V2f>> uvs(scene.meshes.size());
  for (std::size_t m = 0; m < uvs.size(); ++m) {
    if (scene.meshes[m].has_strands()) continue;
    for (const VertexSource& source : scene.meshes[m].sources) {
      const std::vector<V2f> all = file.uvs(source.mesh, source.primitive, set);
      if (all.empty()) return {};
      for (std::uint32_t i = 0; i < source.count; ++i)
        uvs[m].push_back(all.at(source.used.empty() ? i : source.used[i]));
    }
  }
  return uvs;
}

/// The vertices of one primitive by the chart that shows them.
class VertexCopies {
 public:
  VertexCopies(const VertexSource& source, gltf::TexturedPrimitive& primitive)
      : source_(source), primitive_(primitive) {}

  void add_corner(std::uint32_t vertex, std::uint32_t chart, const V2f& uv) {
    const auto [at, is_new] = copies_.try_emplace(
        std::uint64_t{vertex} << 32 | chart, static_cast<std::uint32_t>(primitive_.source.size()));
    if (is_new) {
      const std::uint32_t i = vertex - source_.first;
      primitive_.source.push_back(source_.used.empty() ? i : source_.used[i]);
      primitive_.uvs.push_back(uv);
    }
    primitive_.indices.push_back(at->second);
  }

 private:
  const VertexSource& source_;
  gltf::TexturedPrimitive& primitive_;
  std::map<std::uint64_t, std::uint32_t> copies_;
};

}  // namespace

FileUvs choose_uvs(const gltf::SourceFile& file, const Scene& scene, const BakeOptions& options) {
  FileUvs chosen;
  for (const std::uint32_t set : {1u, 0u}) {
    std::vector<std::vector<V2f>> uvs = uvs_of_set(file, scene, set);
    if (uvs.empty()) continue;
    const std::string fault = fault_of(scene, uvs, options);
    if (fault.empty()) return {std::move(uvs), set, {}};
    if (!chosen.note.empty()) chosen.note += "; ";
    chosen.note += fmt::format("TEXCOORD_{} {}", set, fault);
  }
  return chosen;
}

std::vector<gltf::TexturedPrimitive> textured_primitives(const gltf::SourceFile& file,
                                                         const Scene& scene,
                                                         const TextureLayout& layout,
                                                         std::uint32_t set) {
  std::vector<gltf::TexturedPrimitive> primitives;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (layout.corners[m].empty()) continue;
    const Mesh& mesh = scene.meshes[m];
    std::size_t corner = 0;
    for (const VertexSource& source : mesh.sources) {
      gltf::TexturedPrimitive primitive{source.mesh, source.primitive, set, {}, {}, {}};
      VertexCopies copies(source, primitive);
      for (; corner < mesh.indices.size() && mesh.indices[corner] < source.first + source.count;
           ++corner)
        if (!layout.chart_of.empty())
          copies.add_corner(mesh.indices[corner], layout.chart_of[m][corner / 3],
                            layout.corners[m][corner]);
      if (!layout.chart_of.empty()) primitive.uv_set = file.uv_sets(source.mesh, source.primitive);
      primitives.push_back(std::move(primitive));
    }
  }
  return primitives;
}

std::string occlusion_png(const BakedTexture& texture, int bits) {
  const auto side = static_cast<int>(texture.size);
  const float largest = bits == 16 ? 65535.0f : 255.0f;
  std::vector<std::uint16_t> grey;
  grey.reserve(texture.ao.size());
  for (const float ao : texture.ao)
    grey.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(ao, 0.0f, 1.0f) * largest)));
  if (bits == 16) return encode_grey16_png(side, side, grey, "the texture");
  return encode_png({side, side, 1, {grey.begin(), grey.end()}}, "the texture");
}

void write_baked_exr(const BakeResult& result, const std::string& path) {
  const BakedTexture& texture = result.texture;
  Film film;
  film.width = film.height = static_cast<int>(texture.size);
  film.data_window = {0, 0, film.width - 1, film.height - 1};
  film.planes.push_back({"ao", texture.ao});
  const auto add = [&](const std::string& layer, const char* letters,
                       const std::vector<V3f>& values) {
    for (int axis = 0; axis < 3; ++axis) {
      Plane plane{layer + "." + letters[axis], {}};
      plane.pixels.reserve(values.size());
      for (const V3f& value : values) plane.pixels.push_back(value[axis]);
      film.planes.push_back(std::move(plane));
    }
  };
  if (!texture.bent.empty()) add("bent", "XYZ", texture.bent);
  for (std::size_t l = 0; l < texture.light.size(); ++l)
    add("light." + result.light_names[l], "RGB", texture.light[l]);
  write_exr(film, path);
}

}  // namespace dapple
