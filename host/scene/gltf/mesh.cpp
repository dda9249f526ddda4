// Reading geometry: see mesh.hpp.
#include "scene/gltf/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "scene/gltf/accessor.hpp"
#include "scene/gltf/message.hpp"
#include "scene/gltf/triangles.hpp"

namespace dapple::gltf {
namespace {

/// Primitives may share accessors, so that a small file could ask for any number of triangles:
/// it gets as many as are built in seconds, and no more than its bytes can hold beyond that.
std::uint64_t most_triangles(const Document& document) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 28;
  return std::min(kMost, (std::uint64_t{1} << 22) + document.bytes / 2);
}

/// The same for sparse values, which are read again for every primitive.
std::uint64_t most_sparse_values(const Document& document) {
  return (std::uint64_t{1} << 24) + 4 * document.bytes;
}

constexpr std::initializer_list<Component> kFloatOrQuantized = {
    Component::float32, Component::int8, Component::uint8, Component::int16, Component::uint16};

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

/// Compressed primitives carry plain accessors too where their writer was kind.
void refuse_compressed(const Document& document, const tinygltf::Primitive& primitive,
                       const std::string& who) {
  if (!primitive.extensions.contains("KHR_draco_mesh_compression")) return;
  const auto& position =
      document.model.accessors[static_cast<std::size_t>(attribute(primitive, "POSITION"))];
  if (position.bufferView >= 0 || position.sparse.isSparse) return;
  fail(document.file,
       "{} exists only as KHR_draco_mesh_compression, which dapple cannot read; export it "
       "uncompressed",
       who);
}

/// The accessors of one primitive that dapple looks at.
struct Attributes {
  AccessorReader positions;
  std::optional<AccessorReader> uvs;
  std::optional<AccessorReader> colors;
};

AccessorReader read_positions(const Document& document, const tinygltf::Primitive& primitive,
                              const std::string& who) {
  const int accessor = attribute(primitive, "POSITION");
  require_type(document, accessor, who + " POSITION", {TINYGLTF_TYPE_VEC3}, kFloatOrQuantized);
  return {document, accessor};
}

std::optional<AccessorReader> read_uvs(const Document& document,
                                       const tinygltf::Primitive& primitive,
                                       const AlphaLookup& lookup, const std::string& who,
                                       MeshTotals& totals) {
  const std::string name = fmt::format("TEXCOORD_{}", lookup.texcoord);
  const int accessor = attribute(primitive, name);
  if (accessor < 0) {
    ++totals.without_texcoord;
    return {};
  }
  require_type(document, accessor, who + " " + name, {TINYGLTF_TYPE_VEC2}, kFloatOrQuantized);
  return AccessorReader(document, accessor);
}

/// COLOR_0 where it has an alpha.
std::optional<AccessorReader> read_colors(const Document& document,
                                          const tinygltf::Primitive& primitive,
                                          const std::string& who) {
  const int accessor = attribute(primitive, "COLOR_0");
  if (accessor < 0) return {};
  require_type(document, accessor, who + " COLOR_0", {TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4},
               {Component::float32, Component::uint8, Component::uint16});
  AccessorReader colors(document, accessor);
  if (colors.components() < 4) return {};
  return colors;
}

/// Renumbers `corners` 0, 1, 2... and returns the vertices that they used, in order, or
/// nothing where they may use all of them: primitives often share one long vertex
/// buffer, and copying all of it for each would square a file's size.
std::optional<std::vector<std::uint32_t>> compact(std::vector<std::uint32_t>& corners,
                                                  std::uint64_t vertices) {
  if (corners.size() >= vertices) return {};
  std::vector<std::uint32_t> used = corners;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (std::uint32_t& corner : corners) {
    corner = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) -
                                        used.begin());
  }
  return used;
}

V2f finite_or_zero(V2f uv) { return std::isfinite(uv.x) && std::isfinite(uv.y) ? uv : V2f(0, 0); }

/// NaN becomes 0.
float clamp_alpha(float alpha) { return alpha > 0.0f ? std::min(alpha, 1.0f) : 0.0f; }

/// Appends vertices to `mesh`; arrays that only some primitives have are filled with
/// their defaults, uv (0, 0) and alpha 1, for the others.
void append_vertices(Mesh& mesh, const Attributes& attributes, const AlphaLookup& lookup,
                     const std::optional<std::vector<std::uint32_t>>& used) {
  const std::size_t base = mesh.positions.size();
  const std::size_t count = used ? used->size() : attributes.positions.count();
  const auto source = [&](std::size_t i) -> std::uint64_t { return used ? (*used)[i] : i; };
  mesh.positions.resize(base + count);
  for (std::size_t i = 0; i < count; ++i) {
    mesh.positions[base + i] = attributes.positions.vec3(source(i));
  }
  if (attributes.uvs || !mesh.uvs.empty()) mesh.uvs.resize(base + count, V2f(0, 0));
  if (attributes.uvs) {
    for (std::size_t i = 0; i < count; ++i) {
      mesh.uvs[base + i] = finite_or_zero(lookup.apply(attributes.uvs->vec2(source(i))));
    }
  }
  if (attributes.colors || !mesh.vertex_alpha.empty()) mesh.vertex_alpha.resize(base + count, 1.0f);
  if (attributes.colors) {
    for (std::size_t i = 0; i < count; ++i) {
      mesh.vertex_alpha[base + i] = clamp_alpha(attributes.colors->normalized(source(i), 3));
    }
  }
}

void append_triangles(Mesh& mesh, const std::vector<std::uint32_t>& corners, std::size_t base,
                      std::uint32_t material) {
  for (const std::uint32_t corner : corners) {
    mesh.indices.push_back(static_cast<std::uint32_t>(base) + corner);
  }
  mesh.materials.insert(mesh.materials.end(), corners.size() / 3, material);
}

void append_primitive(const Document& document, const tinygltf::Primitive& primitive,
                      std::uint32_t material_index, const Material& material,
                      const AlphaLookup& lookup, const std::string& who, Mesh& mesh,
                      MeshTotals& totals) {
  Attributes attributes{read_positions(document, primitive, who), {}, {}};
  if (material.alpha_texture >= 0) {
    attributes.uvs = read_uvs(document, primitive, lookup, who, totals);
  }
  if (material.alpha_mode != AlphaMode::opaque) {
    attributes.colors = read_colors(document, primitive, who);
  }
  std::vector<std::uint32_t> corners = triangle_corners(document, primitive, who);
  const auto used = compact(corners, attributes.positions.count());
  const std::size_t base = mesh.positions.size();
  const std::size_t added = used ? used->size() : attributes.positions.count();
  if (base + added > std::numeric_limits<std::uint32_t>::max()) {
    fail(document.file, "{}: its mesh has more than 2^32 vertices", who);
  }
  append_vertices(mesh, attributes, lookup, used);
  append_triangles(mesh, corners, base, material_index);
}

/// False, and counted, for what is not made of triangles.
bool is_shown(const tinygltf::Primitive& primitive, MeshTotals& totals) {
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
    ++totals.lines_and_points;
    return false;
  }
  if (attribute(primitive, "POSITION") < 0) {
    ++totals.without_position;
    return false;
  }
  if (!primitive.targets.empty()) ++totals.morphed;
  return true;
}

std::uint64_t sparse_values(const Document& document, int accessor) {
  if (accessor < 0) return 0;
  const auto& sparse = document.model.accessors[static_cast<std::size_t>(accessor)].sparse;
  return sparse.isSparse ? static_cast<std::uint64_t>(sparse.count) : 0;
}

void count_work(const Document& document, const tinygltf::Primitive& primitive,
                const std::string& who, MeshTotals& totals) {
  totals.triangles += triangle_count(document, primitive, who);
  if (totals.triangles > most_triangles(document)) {
    fail(document.file, "{} brings the triangles to {} (at most {} in a scene of {} bytes)", who,
         grouped(totals.triangles), grouped(most_triangles(document)), grouped(document.bytes));
  }
  totals.sparse_values += sparse_values(document, primitive.indices);
  for (const auto& [name, accessor] : primitive.attributes) {
    totals.sparse_values += sparse_values(document, accessor);
  }
  if (totals.sparse_values > most_sparse_values(document)) {
    fail(document.file, "{} brings the sparse values to {} (at most {} in a scene of {} bytes)",
         who, grouped(totals.sparse_values), grouped(most_sparse_values(document)),
         grouped(document.bytes));
  }
}

/// The primitives that are shown, all counted before the first is read.
std::vector<std::size_t> shown_primitives(const Document& document, const tinygltf::Mesh& mesh,
                                          const std::string& label, MeshTotals& totals) {
  std::vector<std::size_t> shown;
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    if (!is_shown(mesh.primitives[p], totals)) continue;
    const std::string who = fmt::format("{} primitive {}", label, p);
    refuse_compressed(document, mesh.primitives[p], who);
    count_work(document, mesh.primitives[p], who, totals);
    shown.push_back(p);
  }
  return shown;
}

/// A part while it grows; `emitter` as in MeshPart.
struct Draft {
  int emitter;
  Mesh mesh;
};

Mesh& draft_for(std::vector<Draft>& drafts, int emitter) {
  for (Draft& draft : drafts) {
    if (draft.emitter == emitter) return draft.mesh;
  }
  drafts.push_back({emitter, {}});
  return drafts.back().mesh;
}

}  // namespace

std::vector<MeshPart> read_mesh(const Document& document, int index, const MaterialSet& materials,
                                Scene& scene, MeshTotals& totals) {
  const auto& given = document.model.meshes[static_cast<std::size_t>(index)];
  const std::string label = element("mesh", static_cast<std::size_t>(index), given.name);
  std::vector<Draft> drafts;
  for (const std::size_t p : shown_primitives(document, given, label, totals)) {
    const tinygltf::Primitive& primitive = given.primitives[p];
    const std::string who = fmt::format("{} primitive {}", label, p);
    const std::uint32_t at = materials.index_of(primitive.material);
    const Material& material = scene.materials[at];
    Mesh& mesh = draft_for(drafts, emits(material) ? static_cast<int>(at) : -1);
    append_primitive(document, primitive, at, material, materials.lookups[at], who, mesh, totals);
  }
  std::vector<MeshPart> parts;
  for (Draft& draft : drafts) {
    if (draft.mesh.materials.empty()) continue;
    draft.mesh.name = given.name.empty() ? fmt::format("mesh_{}", index) : one_line(given.name);
    if (draft.emitter >= 0) {
      draft.mesh.name += " (" + scene.materials[std::size_t(draft.emitter)].name + ")";
    }
    parts.push_back({static_cast<std::uint32_t>(scene.meshes.size()), draft.emitter});
    scene.meshes.push_back(std::move(draft.mesh));
  }
  return parts;
}

}  // namespace dapple::gltf
