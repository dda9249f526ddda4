#include "commands/bake/baked_texture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "bake/texture/texture_layout.hpp"
#include "bake/texture/uv_overlap.hpp"
#include "dapple/film.hpp"
#include "film/exr/exr_output.hpp"
#include "film/opacity_settings.hpp"
#include "film/preview/png.hpp"
#include "sampling/bias_estimate.hpp"

namespace dapple {
namespace {

/// Overlaps up to this share are roundings at the borders of neighbouring triangles.
constexpr double kMaxOverlap = 1e-3;

/// glTF 2.0, 3.7.2.1: viewers should support at least two sets of texture coordinates.
constexpr std::uint32_t kLastCommonSet = 1;

/// Of a larger share of the surface without area in the texture, the values would be lost.
constexpr double kMaxWithoutTexels = 0.01;

/// Coordinates that fill a smaller part of the texture's width and height leave next to no texels:
/// quantized ones do before their KHR_texture_transform, which bakes do not apply.
constexpr float kLeastExtent = 1.0f / 8;

/// The part of the texture's width or height, the larger one, that the coordinates fill.
float extent_of(const std::vector<std::vector<V2f>>& uvs) {
  Imath::Box2f box;
  for (const std::vector<V2f>& of_mesh : uvs)
    for (const V2f& uv : of_mesh) box.extendBy(uv);
  return box.isEmpty() ? 0.0f : std::max(box.size().x, box.size().y);
}

/// What overlaps in the texture coordinates `name`: triangles of one mesh, or meshes, or both.
std::string overlap_text(const std::string& name, const UvOverlap& overlap) {
  const std::string among = fmt::format("{:.1f} %", 100 * overlap.among);
  if (overlap.within <= kMaxOverlap && overlap.within <= overlap.among)
    return fmt::format(
        "meshes overlap each other in {} in {} of its texels (all share one texture)", name, among);
  const std::string itself =
      fmt::format("{} overlaps itself in {:.1f} % of its texels", name, 100 * overlap.within);
  if (overlap.among <= kMaxOverlap) return itself;
  return fmt::format("{}, and meshes overlap each other in {} (all share one texture)", itself,
                     among);
}

/// Why the texture coordinates `name` cannot be used; empty: they can.
std::string fault_of(const std::string& name, const Scene& scene,
                     const std::vector<std::vector<V2f>>& uvs, const BakeOptions& options) {
  const UvOverlap overlap = find_overlap(scene, uvs, options.texture_size, options.placement);
  if (std::isinf(overlap.share)) return name + " leaves the texture";
  if (overlap.share > kMaxOverlap) return overlap_text(name, overlap);
  const double without = share_without_texels(scene, uvs, options.texture_size, options.placement);
  if (without > kMaxWithoutTexels)
    return fmt::format("{} has no area in the texture for {:.1f} % of the surface", name,
                       100 * without);
  const float extent = extent_of(uvs);
  if (extent < kLeastExtent)
    return fmt::format(
        "{} fills {:.1f} % of the texture's width and height at most (are they "
        "scaled by KHR_texture_transform?)",
        name, 100 * extent);
  return {};
}

using UvSet = std::optional<std::uint32_t>;

/// TEXCOORD_n for each mesh and vertex, n = `set`, or that of the occlusion texture; empty if a
/// primitive has none. `missing`: that primitive, if others have one.
std::vector<std::vector<V2f>> uvs_of_set(const gltf::SourceFile& file, const Scene& scene,
                                         UvSet set, std::string& missing) {
  std::vector<std::vector<V2f>> uvs(scene.meshes.size());
  bool some = false;
  for (std::size_t m = 0; m < uvs.size(); ++m) {
    if (scene.meshes[m].has_strands()) continue;
    for (const VertexSource& source : scene.meshes[m].sources) {
      const UvSet of_it = set ? set : file.occlusion_set(source.mesh, source.primitive);
      std::vector<V2f> own;
      if (of_it) own = file.uvs(source, *of_it);
      some = some || !own.empty();
      if (own.empty()) {
        if (missing.empty() && set)
          missing = fmt::format("primitive {} of mesh {} has no TEXCOORD_{}", source.primitive,
                                source.mesh, *set);
        if (!set) return {};
        continue;
      }
      uvs[m].insert(uvs[m].end(), own.begin(), own.end());
    }
  }
  if (!some) missing.clear();
  return some && missing.empty() ? std::move(uvs) : std::vector<std::vector<V2f>>{};
}

/// The vertices of one primitive by the chart that shows them. Of primitives that use all vertices
/// of their accessors these keep their numbers, by which extensions may know them; copies follow.
class VertexCopies {
 public:
  VertexCopies(const VertexSource& source, gltf::TexturedPrimitive& primitive)
      : source_(source), primitive_(primitive), is_free_(source.used.empty() ? source.count : 0) {
    is_free_.flip();
    primitive.source.resize(is_free_.size());
    std::iota(primitive.source.begin(), primitive.source.end(), 0u);
    primitive.uvs.resize(is_free_.size(), V2f(0, 0));
  }

  void add_corner(std::uint32_t vertex, std::uint32_t chart, const V2f& uv) {
    const std::uint32_t i = vertex - source_.first;
    const bool keeps_its_number = i < is_free_.size() && is_free_[i];
    const auto number = keeps_its_number ? i : static_cast<std::uint32_t>(primitive_.source.size());
    const auto [at, is_new] = copies_.try_emplace(std::uint64_t{vertex} << 32 | chart, number);
    if (is_new && keeps_its_number) {
      is_free_[i] = false;
      primitive_.uvs[i] = uv;
    } else if (is_new) {
      primitive_.source.push_back(source_.used.empty() ? i : source_.used[i]);
      primitive_.uvs.push_back(uv);
    }
    primitive_.indices.push_back(at->second);
  }

 private:
  const VertexSource& source_;
  gltf::TexturedPrimitive& primitive_;
  std::vector<bool> is_free_;  ///< vertices that no chart has shown yet
  std::map<std::uint64_t, std::uint32_t> copies_;
};

/// As render() makes them. The options of places, such as the margin, are not among them: the
/// texture shows them.
FilmMetadata metadata_of(const BakeStatistics& statistics, const std::string& source,
                         const BakeOptions& options) {
  FilmMetadata m;
  m.samples = options.rays;
  m.seed = options.seed;
  m.scene = source;
  m.device = statistics.device;
  m.version = DAPPLE_VERSION;
  const auto set = [&](const std::string& name, const auto& value) {
    m.settings.emplace_back(name, fmt::format("{}", value));
  };
  set("estimator", name_of(options.estimator));
  set("normals", name_of(options.normals));
  set("footprint", statistics.footprint);
  if (options.max_bias > 0) set("max_bias", options.max_bias);
  if (options.target_error > 0) set("target_error", options.target_error);
  set("rays", options.rays);
  if (options.light) set("light_rays", options.light_rays);
  set("ao_distance", options.distance);
  set("ao_falloff", options.falloff);
  for (auto& setting : opacity_settings(options.opacity)) m.settings.push_back(std::move(setting));
  for (const auto& [layer, bias] : statistics.bias) set("bias." + layer, bias_text(bias));
  return m;
}

/// The first TEXCOORD_n that a primitive lacks and none of its textures names: one that does reads
/// the texel at 0, 0, and must go on to.
std::uint32_t free_uv_set(const gltf::SourceFile& file, const VertexSource& source) {
  const std::vector<std::string> has = file.attributes(source.mesh, source.primitive);
  std::uint32_t set = file.uv_sets(source.mesh, source.primitive);
  while (std::find(has.begin(), has.end(), fmt::format("TEXCOORD_{}", set)) != has.end() ||
         !file.texture_with_uvs(source.mesh, source.primitive, set).empty())
    ++set;
  return set;
}

}  // namespace

FileUvs choose_uvs(const gltf::SourceFile& file, const Scene& scene, const BakeOptions& options) {
  FileUvs chosen;
  for (const UvSet set : {UvSet(1), UvSet(0), UvSet()}) {
    std::string fault;
    std::vector<std::vector<V2f>> uvs = uvs_of_set(file, scene, set, fault);
    if (!uvs.empty()) {
      fault = fault_of(set ? fmt::format("TEXCOORD_{}", *set) : "", scene, uvs, options);
      if (fault.empty()) return {std::move(uvs), set, chosen.note};
    }
    if (fault.empty() || !set) continue;
    if (!chosen.note.empty()) chosen.note += "; ";
    chosen.note += fault;
  }
  return chosen;
}

std::vector<gltf::TexturedPrimitive> textured_primitives(const gltf::SourceFile& file,
                                                         const Scene& scene,
                                                         const TextureLayout& layout, UvSet set) {
  std::vector<gltf::TexturedPrimitive> primitives;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (layout.corners[m].empty()) continue;
    const Mesh& mesh = scene.meshes[m];
    std::size_t corner = 0;
    for (const VertexSource& source : mesh.sources) {
      const UvSet of_it = set ? set : file.occlusion_set(source.mesh, source.primitive);
      gltf::TexturedPrimitive primitive{source.mesh, source.primitive, of_it.value_or(0), {}, {},
                                        {}};
      std::optional<VertexCopies> copies_of;
      if (!layout.chart_of.empty()) copies_of.emplace(source, primitive);
      for (; corner < mesh.indices.size() && mesh.indices[corner] < source.first + source.count;
           ++corner)
        if (copies_of)
          copies_of->add_corner(mesh.indices[corner], layout.chart_of[m][corner / 3],
                                layout.corners[m][corner]);
      if (copies_of) primitive.uv_set = free_uv_set(file, source);
      primitives.push_back(std::move(primitive));
    }
  }
  return primitives;
}

std::string coordinates_note(const TextureLayout& layout,
                             const std::vector<gltf::TexturedPrimitive>& primitives,
                             const std::string& fault) {
  std::set<std::uint32_t> sets;
  for (const gltf::TexturedPrimitive& primitive : primitives) sets.insert(primitive.uv_set);
  if (sets.empty()) return {};
  const std::string names = fmt::format("TEXCOORD_{}", fmt::join(sets, " or TEXCOORD_"));
  const std::string reason = fault.empty() ? "" : fault + ": ";
  if (layout.chart_of.empty()) return reason + "the texture uses " + names;
  return fmt::format(
      "{}the texture has coordinates of its own, {}{}", reason, names,
      *sets.rbegin() > kLastCommonSet ? "; glTF viewers need not read sets beyond TEXCOORD_1" : "");
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

void write_baked_exr(const BakeResult& result, const std::string& source,
                     const BakeOptions& options, PendingFile& file) {
  const BakedTexture& texture = result.texture;
  Film film;
  film.width = film.height = static_cast<int>(texture.size);
  film.data_window = {0, 0, film.width - 1, film.height - 1};
  film.metadata = metadata_of(result.statistics, source, options);
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
  write_exr(film, file, {}, Durable::yes);
}

}  // namespace dapple
