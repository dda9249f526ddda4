// Describes a scene in terms of glTF 2.0 (Khronos, glTF 2.0 Specification, sections 3 and 5):
// buffer views, accessors, primitives, nodes, cameras.
#include "scene/glb/glb_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "dapple/error.hpp"
#include "scene/check/finite.hpp"
#include "scene/glb/glb_primitives.hpp"
#include "scene/gltf/document/extension_names.hpp"

namespace dapple {
namespace {

using Json = nlohmann::json;

// glTF uses OpenGL's codes.
constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;
constexpr double kNear = 0.01;
constexpr double kOrthographicFar = 1e4;

Json vector_json(V3f v) { return {v.x, v.y, v.z}; }

Json matrix_json(const M44f& m) {
  // Our matrix multiplies row vectors, so its rows are the columns of glTF's matrix.
  Json elements = Json::array();
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) elements.push_back(m[i][k]);
  }
  return elements;
}

float largest_channel(const V3f& color) { return std::max({color.x, color.y, color.z}); }

/// Which materials emit from an instance: lights that were taken out of the scene stay out.
std::vector<bool> shining_materials(const Scene& scene) {
  std::vector<bool> shining(scene.materials.size()), shows(scene.meshes.size());
  for (const Instance& instance : scene.instances)
    if (instance.light >= 0) shows[instance.mesh] = true;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (std::size_t i = 0; shows[m] && i < scene.meshes[m].materials.size(); ++i)
      shining.at(scene.meshes[m].materials[i]) = true;
  return shining;
}

/// `shines`: an instance emits what the material does.
Json material_json(const Material& material, bool shines) {
  Json json = {
      {"name", material.name},
      {"doubleSided", material.double_sided},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {material.color.x, material.color.y, material.color.z, material.alpha}},
        {"metallicFactor", 0}}}};
  if (material.alpha_mode == AlphaMode::blend) json["alphaMode"] = "BLEND";
  if (material.alpha_mode == AlphaMode::mask) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = material.alpha_cutoff;
  }
  const float brightest = shines ? largest_channel(material.emission) : 0;
  if (brightest > 0)
    json["emissiveFactor"] = vector_json(material.emission / std::max(brightest, 1.0f));
  if (brightest > 1) {
    json["extensions"][gltf::extension::kEmissiveStrength]["emissiveStrength"] = brightest;
  }
  return json;
}

Json projection_json(const Camera& camera) {
  if (camera.kind == Camera::Kind::perspective) {
    return {{"name", camera.name},
            {"type", "perspective"},
            {"perspective", {{"yfov", camera.fov_y}, {"znear", kNear}}}};
  }
  return {{"name", camera.name},
          {"type", "orthographic"},
          {"orthographic",
           {{"xmag", camera.half_height},
            {"ymag", camera.half_height},
            {"znear", kNear},
            {"zfar", kOrthographicFar}}}};
}

Json camera_json(const Camera& camera) {
  Json json = projection_json(camera);
  if (camera.lens_radius > 0) json["extras"]["dapple_aperture"] = camera.lens_radius;
  if (camera.focus_distance > 0) json["extras"]["dapple_focus_distance"] = camera.focus_distance;
  return json;
}

Box3f finite_bounds(std::span<const V3f> positions, const std::string& mesh) {
  Box3f bounds;
  for (const V3f& p : positions) {
    if (!is_finite(p)) {
      throw Error(ErrorKind::failed,
                  fmt::format("mesh \"{}\" has a vertex that is not finite", mesh));
    }
    bounds.extendBy(p);
  }
  return bounds;
}

template <typename Value>
std::vector<Value> take(const std::vector<Value>& values, const std::vector<std::uint32_t>& at) {
  std::vector<Value> taken;
  if (values.empty()) return taken;
  taken.reserve(at.size());
  for (const std::uint32_t i : at) taken.push_back(values[i]);
  return taken;
}

/// Colours of the vertices, or white, with their alphas, or 1: four floats per vertex.
std::vector<float> rgba_of(const std::vector<V3f>& colors, const std::vector<float>& alpha) {
  const std::size_t count = std::max(colors.size(), alpha.size());
  std::vector<float> rgba;
  rgba.reserve(4 * count);
  for (std::size_t v = 0; v < count; ++v) {
    const V3f color = colors.empty() ? V3f(1, 1, 1) : colors[v];
    rgba.insert(rgba.end(), {color.x, color.y, color.z, alpha.empty() ? 1.0f : alpha[v]});
  }
  return rgba;
}

class Describer {
 public:
  explicit Describer(const Scene& scene) : scene_(scene) {}

  GlbLayout describe() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "dapple"}};
    shining_ = shining_materials(scene_);
    for (std::size_t m = 0; m < scene_.materials.size(); ++m)
      json_["materials"].push_back(material_json(scene_.materials[m], shining_[m]));
    for (const Mesh& mesh : scene_.meshes) add_mesh(mesh);
    for (const Instance& instance : scene_.instances) add_instance(instance);
    for (const Camera& camera : scene_.cameras) add_camera(camera);
    finish();
    return std::move(layout_);
  }

 private:
  // Returns the accessor's number. Components have 4 bytes, so that all views are aligned.
  std::size_t add_accessor(std::span<const std::byte> bytes, const Json& accessor, int target) {
    json_["bufferViews"].push_back({{"buffer", 0},
                                    {"byteOffset", layout_.byte_count},
                                    {"byteLength", bytes.size()},
                                    {"target", target}});
    layout_.sections.push_back(bytes);
    layout_.byte_count += bytes.size();
    Json entry = accessor;
    entry["bufferView"] = json_["bufferViews"].size() - 1;
    json_["accessors"].push_back(entry);
    return json_["accessors"].size() - 1;
  }

  std::size_t add_positions(std::span<const V3f> positions, const std::string& mesh) {
    const Box3f bounds = finite_bounds(positions, mesh);
    return add_accessor(std::as_bytes(positions),
                        {{"componentType", kFloat},
                         {"type", "VEC3"},
                         {"count", positions.size()},
                         {"min", vector_json(bounds.min)},
                         {"max", vector_json(bounds.max)}},
                        kArrayBuffer);
  }

  const std::vector<V3f>& keep(std::vector<V3f> vectors) {
    layout_.made_vectors.push_back(std::move(vectors));
    return layout_.made_vectors.back();
  }

  std::size_t add_indices(std::vector<std::uint32_t> indices) {
    layout_.made_indices.push_back(std::move(indices));
    const auto& kept = layout_.made_indices.back();
    return add_accessor(
        std::as_bytes(std::span(kept)),
        {{"componentType", kUnsignedInt}, {"type", "SCALAR"}, {"count", kept.size()}},
        kElementArrayBuffer);
  }

  /// Adds COLOR_0 to `attributes` if there are colours or alphas.
  void add_colours(const std::vector<V3f>& colors, const std::vector<float>& alpha,
                   Json& attributes) {
    if (colors.empty() && alpha.empty()) return;
    layout_.made_colours.push_back(rgba_of(colors, alpha));
    const auto& kept = layout_.made_colours.back();
    attributes["COLOR_0"] = add_accessor(
        std::as_bytes(std::span(kept)),
        {{"componentType", kFloat}, {"type", "VEC4"}, {"count", kept.size() / 4}}, kArrayBuffer);
  }

  // Leaves out empty meshes, which glTF does not allow; later meshes then get lower numbers.
  void add_mesh(const Mesh& mesh) {
    mesh_numbers_.push_back(-1);
    if (mesh.primitive_count() == 0) return;
    if (mesh.has_strands()) {
      throw Error(ErrorKind::usage,
                  fmt::format("\"{:.100}\": glTF has no strands; render {} without writing it",
                              mesh.name, scene_.source));
    }
    Json primitives = Json::array();
    std::array<Json, 2> of_all_vertices;  // shared by the primitives without normals
    for (GlbPrimitive& primitive : split_into_primitives(mesh, scene_.materials.size())) {
      const bool with_alpha = scene_.materials[primitive.material].uses_vertex_alpha;
      Json attributes;
      if (primitive.has_normals()) {
        attributes = add_smooth_vertices(mesh, primitive, with_alpha);
      } else {
        Json& shared = of_all_vertices[with_alpha ? 1 : 0];
        if (shared.is_null()) shared = add_all_vertices(mesh, with_alpha);
        attributes = shared;
      }
      primitives.push_back({{"attributes", attributes},
                            {"indices", add_indices(std::move(primitive.indices))},
                            {"material", primitive.material}});
    }
    mesh_numbers_.back() = static_cast<int>(json_["meshes"].size());
    json_["meshes"].push_back({{"name", mesh.name}, {"primitives", primitives}});
  }

  // Returns the attributes of a primitive without normals.
  Json add_all_vertices(const Mesh& mesh, bool with_alpha) {
    Json attributes = {{"POSITION", add_positions(mesh.positions, mesh.name)}};
    add_colours(mesh.colors, with_alpha ? mesh.vertex_alpha : std::vector<float>{}, attributes);
    return attributes;
  }

  Json add_smooth_vertices(const Mesh& mesh, const GlbPrimitive& primitive, bool with_alpha) {
    const auto& used = primitive.vertices;
    Json attributes;
    attributes["POSITION"] = add_positions(keep(take(mesh.positions, used)), mesh.name);
    attributes["NORMAL"] = add_accessor(
        std::as_bytes(std::span(keep(take(mesh.normals, used)))),
        {{"componentType", kFloat}, {"type", "VEC3"}, {"count", used.size()}}, kArrayBuffer);
    add_colours(take(mesh.colors, used),
                with_alpha ? take(mesh.vertex_alpha, used) : std::vector<float>{}, attributes);
    return attributes;
  }

  void add_instance(const Instance& instance) {
    const int mesh = mesh_numbers_[instance.mesh];
    if (mesh < 0) return;
    const auto node = static_cast<std::size_t>(instance.node);
    const bool has_name = instance.node >= 0 && node < scene_.node_names.size();
    const std::string name = has_name ? scene_.node_names[node] : "";
    add_node({{"name", name.empty() ? scene_.meshes[instance.mesh].name : name}, {"mesh", mesh}},
             instance.to_world);
  }

  void add_camera(const Camera& camera) {
    json_["cameras"].push_back(camera_json(camera));
    add_node({{"name", camera.name}, {"camera", json_["cameras"].size() - 1}}, camera.to_world);
  }

  void add_node(Json node, const M44f& to_world) {
    if (to_world != M44f{}) node["matrix"] = matrix_json(to_world);
    root_nodes_.push_back(json_["nodes"].size());
    json_["nodes"].push_back(std::move(node));
  }

  void finish() {
    json_["scene"] = 0;
    json_["scenes"] = {{{"name", scene_.source}}};
    if (!root_nodes_.empty()) json_["scenes"][0]["nodes"] = root_nodes_;
    if (layout_.byte_count > 0) json_["buffers"] = {{{"byteLength", layout_.byte_count}}};
    for (std::size_t m = 0; m < scene_.materials.size(); ++m)
      if (shining_[m] && largest_channel(scene_.materials[m].emission) > 1)
        json_["extensionsUsed"] = {gltf::extension::kEmissiveStrength};
    // Names may hold bytes that are not UTF-8: dump() replaces them instead of throwing.
    layout_.json = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  const Scene& scene_;
  std::vector<bool> shining_;  ///< by material
  Json json_;
  GlbLayout layout_;
  std::vector<int> mesh_numbers_;
  std::vector<std::size_t> root_nodes_;
};

}  // namespace

GlbLayout lay_out_glb(const Scene& scene) { return Describer(scene).describe(); }

}  // namespace dapple
