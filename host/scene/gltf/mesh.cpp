// Reads geometry: see mesh.hpp.
#include "scene/gltf/mesh.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "scene/gltf/line_joints.hpp"
#include "scene/gltf/topology.hpp"
#include "scene/gltf/vertices.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

/// The limit of triangles and segments. Primitives may share accessors, so a small file could
/// otherwise make any number; above 2^22 elements the limit grows with the file's size.
std::uint64_t max_elements(const Document& document) {
  constexpr std::uint64_t kMax = std::uint64_t{1} << 28;
  return std::min(kMax, (std::uint64_t{1} << 22) + document.bytes / 2);
}

/// The same limit for sparse values, which are read again for every primitive.
std::uint64_t max_sparse_values(const Document& document) {
  return (std::uint64_t{1} << 24) + 4 * document.bytes;
}

/// Returns the attributes of a primitive that its material needs. Only triangles use textures.
AttributeNeeds needs_of(const Material& material, const AlphaLookup& lookup, bool lines,
                        bool colors, MeshTotals& totals) {
  if (lines && lookup.has_texture && material.alpha_mode != AlphaMode::opaque)
    ++totals.textured_lines;
  const bool textured = material.alpha_texture >= 0 || material.color_texture >= 0;
  return {!lines, !lines && textured, material.alpha_mode != AlphaMode::opaque, colors};
}

/// Whether morph targets change texture coordinates or colours that are read, which is ignored.
bool morphs_fixed_attributes(const tinygltf::Primitive& primitive, const AttributeNeeds& needs,
                             const AlphaLookup& lookup) {
  const std::string texcoord = fmt::format("TEXCOORD_{}", lookup.texcoord);
  return std::any_of(primitive.targets.begin(), primitive.targets.end(), [&](const auto& target) {
    return (needs.uvs && target.contains(texcoord)) ||
           ((needs.alphas || needs.colors) && target.contains("COLOR_0"));
  });
}

void append_elements(Mesh& mesh, const std::vector<std::uint32_t>& corners, std::size_t base,
                     std::uint32_t material) {
  for (const std::uint32_t corner : corners) {
    mesh.indices.push_back(static_cast<std::uint32_t>(base) + corner);
  }
  const std::size_t corners_each = mesh.has_strands() ? 2 : 3;
  mesh.materials.insert(mesh.materials.end(), corners.size() / corners_each, material);
}

/// A primitive and what is needed to append it to a mesh.
struct PrimitiveSource {
  const tinygltf::Primitive& primitive;
  std::uint32_t mesh, index;     ///< of the primitive in the file
  std::uint32_t material_index;  ///< into Scene::materials
  const Material& material;
  const AlphaLookup& lookup;
  float line_radius;
  bool colors, mirrored;
  const Deformation& deformation;
  const std::string& who;  ///< for messages
};

void append_primitive(const Document& document, const PrimitiveSource& source, Mesh& mesh,
                      MeshTotals& totals) {
  const auto& [primitive, file_mesh, file_primitive, material_index, material, lookup, line_radius,
               colors, mirrored, deformation, who] = source;
  const bool lines = is_of_lines(primitive);
  const AttributeNeeds needs = needs_of(material, lookup, lines, colors, totals);
  const Attributes attributes = read_attributes(document, primitive, needs, lookup, who);
  totals.without_texcoord.add(needs.uvs && !attributes.uvs ? 1 : 0, who);
  totals.fixed_attributes.add(morphs_fixed_attributes(primitive, needs, lookup) ? 1 : 0, who);
  std::vector<std::uint32_t> corners = element_corners(document, primitive, who);
  totals.without_elements.add(corners.empty() ? 1 : 0, who);
  if (corners.empty()) return;
  const auto& position =
      document.model.accessors[static_cast<std::size_t>(attribute(primitive, "POSITION"))];
  totals.without_view.add(position.bufferView < 0 && !position.sparse.isSparse ? 1 : 0, who);
  const auto used = compact(corners, attributes.positions.count());
  const std::size_t base = mesh.positions.size();
  const std::size_t added = used ? used->size() : attributes.positions.count();
  if (base + added > std::numeric_limits<std::uint32_t>::max()) {
    fail(document.file, "{}: its mesh has more than 2^32 vertices", who);
  }
  const OddValues odd = append_vertices(
      mesh, attributes, VertexDeformer(document, primitive, deformation, who), lookup, used);
  totals.odd_texcoords.add(odd.texcoords, who);
  totals.odd_alphas.add(odd.alphas, who);
  mesh.sources.push_back({file_mesh, file_primitive, static_cast<std::uint32_t>(base),
                          static_cast<std::uint32_t>(added),
                          used ? *used : std::vector<std::uint32_t>{}, mirrored});
  if (lines) mesh.radii.resize(mesh.positions.size(), line_radius);
  const std::size_t first_index = mesh.indices.size();
  append_elements(mesh, corners, base, material_index);
  if (lines) join_lines(mesh, base, first_index);
}

/// Returns false, and counts the reason, for points, for lines without a radius, and for primitives
/// without POSITION.
bool is_shown(const tinygltf::Primitive& primitive, float line_radius, MeshTotals& totals) {
  const bool thin = is_of_lines(primitive) && line_radius == 0;
  const bool points = primitive.mode == TINYGLTF_MODE_POINTS;
  if (thin) ++totals.thin_lines;
  if (points) ++totals.points;
  if (thin || points) return false;
  if (attribute(primitive, "POSITION") < 0) {
    ++totals.without_position;
    return false;
  }
  return true;
}

/// The limit of numbers that deform vertices; primitives and nodes may share them.
constexpr std::uint64_t kMaxDeformed = std::uint64_t{1} << 28;

void count_work(const Document& document, const tinygltf::Primitive& primitive,
                const Deformation& deformation, const std::string& who, MeshTotals& totals) {
  const std::uint64_t elements = element_count(document, primitive, who);
  totals.elements += elements;
  if (totals.elements > max_elements(document)) {
    fail(document.file,
         "{} brings the triangles and segments to {} (at most {} in a scene of {} bytes)", who,
         grouped(totals.elements), grouped(max_elements(document)), grouped(document.bytes));
  }
  totals.sparse_values += sparse_count(document, primitive.indices);
  for (const auto& [name, accessor] : primitive.attributes) {
    totals.sparse_values += sparse_count(document, accessor);
  }
  // A primitive reads at most one vertex per corner.
  const std::uint64_t vertices = std::min<std::uint64_t>(
      3 * elements,
      document.model.accessors[static_cast<std::size_t>(attribute(primitive, "POSITION"))].count);
  totals.deformed += deformation_cost(document, primitive, deformation, vertices);
  if (totals.deformed > kMaxDeformed) {
    fail(document.file, "{} brings the numbers that deform vertices to {} (at most {})", who,
         grouped(totals.deformed), grouped(kMaxDeformed));
  }
  if (totals.sparse_values > max_sparse_values(document)) {
    fail(document.file, "{} brings the sparse values to {} (at most {} in a scene of {} bytes)",
         who, grouped(totals.sparse_values), grouped(max_sparse_values(document)),
         grouped(document.bytes));
  }
}

/// Returns the primitives that are shown. All are counted before the first one is read.
std::vector<std::size_t> shown_primitives(const Document& document, const tinygltf::Mesh& mesh,
                                          const std::string& label, float line_radius,
                                          const Deformation& deformation, MeshTotals& totals) {
  std::vector<std::size_t> shown;
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    if (!is_shown(mesh.primitives[p], line_radius, totals)) continue;
    const std::string who = fmt::format("{} primitive {}", label, p);
    count_work(document, mesh.primitives[p], deformation, who, totals);
    shown.push_back(p);
  }
  return shown;
}

/// A mesh part while primitives are appended to it; `emitter` is as in MeshPart.
struct Draft {
  int emitter;
  bool lines;
  Mesh mesh;
};

Mesh& draft_for(std::vector<Draft>& drafts, int emitter, bool lines) {
  for (Draft& draft : drafts) {
    if (draft.emitter == emitter && draft.lines == lines) return draft.mesh;
  }
  drafts.push_back({emitter, lines, {}});
  return drafts.back().mesh;
}

/// Returns the material that makes a primitive a mesh light, -1 for none. Lines have no area, so
/// they do not emit.
int emitter_of(const Material& material, std::uint32_t at, bool lines, MeshTotals& totals) {
  if (!emits(material)) return -1;
  if (lines) ++totals.shining_lines;
  return lines ? -1 : static_cast<int>(at);
}

std::string part_name(const Draft& draft, const std::string& mesh, const Scene& scene) {
  if (draft.emitter >= 0)
    return mesh + " (" + scene.materials[static_cast<std::size_t>(draft.emitter)].name + ")";
  return draft.lines ? mesh + " (lines)" : mesh;
}

}  // namespace

std::vector<MeshPart> read_mesh(const Document& document, const MeshUse& use,
                                const std::vector<Imath::M44d>* joints,
                                const MaterialSet& materials, Scene& scene, MeshTotals& totals) {
  const auto& given = document.model.meshes[static_cast<std::size_t>(use.mesh)];
  const std::string label = element("mesh", static_cast<std::size_t>(use.mesh), given.name);
  const Deformation deformation{use.weights, joints};
  totals.without_primitives.add(given.primitives.empty() ? 1 : 0, label);
  std::vector<Draft> drafts;
  for (const std::size_t p :
       shown_primitives(document, given, label, use.line_radius, deformation, totals)) {
    const tinygltf::Primitive& primitive = given.primitives[p];
    const bool lines = is_of_lines(primitive);
    const std::string who = fmt::format("{} primitive {}", label, p);
    const std::uint32_t at = materials.index_of(primitive.material);
    const Material& material = scene.materials[at];
    Mesh& mesh = draft_for(drafts, emitter_of(material, at, lines, totals), lines);
    append_primitive(document,
                     {primitive, static_cast<std::uint32_t>(use.mesh),
                      static_cast<std::uint32_t>(p), at, material, materials.lookups[at],
                      use.line_radius, use.colors, use.mirrored, deformation, who},
                     mesh, totals);
  }
  const std::string name =
      given.name.empty() ? fmt::format("mesh_{}", use.mesh) : one_line(given.name);
  std::vector<MeshPart> parts;
  for (Draft& draft : drafts) {
    if (draft.mesh.materials.empty()) continue;
    draft.mesh.name = part_name(draft, name, scene);
    parts.push_back({static_cast<std::uint32_t>(scene.meshes.size()), draft.emitter});
    scene.meshes.push_back(std::move(draft.mesh));
  }
  return parts;
}

}  // namespace dapple::gltf
