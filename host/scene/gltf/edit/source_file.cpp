#include "scene/gltf/edit/source_file.hpp"

#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/edit/material_use.hpp"
#include "scene/gltf/edit/source_content.hpp"
#include "scene/gltf/instance.hpp"
#include "scene/gltf/vertices.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// A number without a fraction that is written with one.
bool is_whole(const Json& number) {
  if (!number.is_number_float()) return false;
  const double value = number.get<double>();
  return value >= 0 && value < 4294967296.0 && value == std::floor(value);
}

void write_whole(Json& number) {
  if (is_whole(number)) number = number.get<std::uint64_t>();
}

/// Of a list of indices, or of objects of indices, as morph targets are.
void write_whole_members(Json& list) {
  for (Json& member : list) {
    write_whole(member);
    if (member.is_object())
      for (Json& index : member) write_whole(index);
  }
}

/// Indices that are written as 1.0 become 1: JSON makes no difference, edits of the file do.
void write_whole_indices(Json& element) {
  static const std::set<std::string, std::less<>> kKeys = {
      "buffer",   "bufferView", "camera", "index",   "indices", "input",   "inverseBindMatrices",
      "light",    "material",   "mesh",   "node",    "output",  "sampler", "scene",
      "skeleton", "skin",       "source", "texCoord"};
  static const std::set<std::string, std::less<>> kLists = {"attributes", "children", "joints",
                                                            "nodes", "targets"};
  for (auto& [key, value] : element.items()) {
    if (key == "extras") continue;
    if (kKeys.contains(key)) write_whole(value);
    if (kLists.contains(key) && value.is_structured()) write_whole_members(value);
    if (value.is_structured()) write_whole_indices(value);
  }
}

using Readers = std::map<std::string, AccessorReader>;

/// A node that stands for instance `i`, without a mesh.
Json node_of_instance(const Readers& readers, std::size_t i) {
  Json node = Json::object();
  for (const auto& [name, reader] : readers) {
    std::vector<float> values;
    if (name == "ROTATION") {
      const Imath::V4d unit = unit_rotation(reader, i);
      for (int c = 0; c < 4; ++c) values.push_back(static_cast<float>(unit[c]));
    } else {
      for (std::uint64_t c = 0; c < reader.components(); ++c) values.push_back(reader.number(i, c));
    }
    const bool is_place = name == "ROTATION" || name == "TRANSLATION" || name == "SCALE";
    (is_place ? node[lower_case(name)] : node["extras"][name]) = values;
  }
  return node;
}

std::string primitive_label(std::uint32_t mesh, std::uint32_t primitive) {
  return fmt::format("mesh {} primitive {}", mesh, primitive);
}

bool has_finite_place(const Json& node) {
  for (const char* key : {"translation", "rotation", "scale"})
    if (node.contains(key))
      for (const Json& value : node[key])
        if (!std::isfinite(value.get<double>())) return false;
  return true;
}

/// What nodes lose that are split.
constexpr const char* kSplitExtensions[] = {extension::kInstancing, extension::kInstanceFeatures};

/// Channels that animate the weights of a node which was split animate those of its `parts`
/// instead; -1: none.
void animate_parts(Json& json, const std::map<int, std::vector<int>>& parts) {
  if (!json.contains("animations")) return;
  for (Json& animation : json["animations"]) {
    Json channels = Json::array();
    for (const Json& channel : animation["channels"]) {
      const Json target = channel.value("target", Json::object());
      const bool is_of_weights = target.value("path", "") == "weights" && target.contains("node");
      const auto split = is_of_weights ? parts.find(target["node"].get<int>()) : parts.end();
      if (split == parts.end()) {
        channels.push_back(channel);
        continue;
      }
      for (const int part : split->second) {
        if (part < 0) continue;
        channels.push_back(channel);
        channels.back()["target"]["node"] = part;
      }
    }
    animation["channels"] = std::move(channels);
  }
}

}  // namespace

SourceFile::SourceFile(const std::string& path, bool allow_outside)
    : content(new Content{
          read_regular_file(path, path), {}, load_document(path, allow_outside), {}, 0}) {
  content->container = split_container(content->bytes, path);
  content->json = Json::parse(content->container.json);
  write_whole_indices(content->json);
  content->meshes_of_file = static_cast<std::uint32_t>(content->document.model.meshes.size());
}
SourceFile::~SourceFile() { delete content; }
SourceFile::SourceFile(SourceFile&& other) noexcept
    : content(std::exchange(other.content, nullptr)) {}

std::size_t SourceFile::vertex_count(std::uint32_t mesh, std::uint32_t primitive) const {
  const int positions = attribute(content->primitive(mesh, primitive), "POSITION");
  return content->document.model.accessors[static_cast<std::size_t>(positions)].count;
}

VertexKey SourceFile::vertex_key(std::uint32_t mesh, std::uint32_t primitive,
                                 const std::string& name) const {
  const auto& p = content->primitive(mesh, primitive);
  return {mesh < content->meshes_of_file ? 0 : mesh,
          static_cast<std::uint32_t>(attribute(p, "POSITION")),
          static_cast<std::uint32_t>(attribute(p, name) + 1)};
}

std::uint32_t SourceFile::copy_mesh(std::uint32_t node, std::uint32_t mesh) {
  auto& meshes = content->document.model.meshes;
  meshes.push_back(tinygltf::Mesh(meshes[mesh]));
  Json& json = content->json;
  json["meshes"].push_back(Json(json["meshes"][mesh]));
  json["nodes"][node]["mesh"] = meshes.size() - 1;
  return static_cast<std::uint32_t>(meshes.size() - 1);
}

bool SourceFile::has_skin(std::uint32_t node) const {
  return content->json["nodes"][node].contains("skin");
}

bool SourceFile::has_gpu_instances(std::uint32_t node) const {
  return has_extension(content->json["nodes"][node], extension::kInstancing);
}

bool SourceFile::has_instance_features(std::uint32_t node) const {
  return has_extension(content->json["nodes"][node], extension::kInstanceFeatures);
}

std::vector<int> SourceFile::split_gpu_instances(std::uint32_t node) {
  Json& nodes = content->json["nodes"];
  const Json attributes =
      nodes[node]["extensions"][extension::kInstancing].value("attributes", Json::object());
  // All have one length; without any there is one instance.
  std::size_t count = 1;
  Readers readers;
  for (const auto& [name, accessor] : attributes.items()) {
    const AccessorReader& reader =
        readers.try_emplace(name, content->document, accessor.get<int>()).first->second;
    count = reader.count();
  }
  std::vector<int> made(count, -1);
  for (std::size_t i = 0; i < count; ++i) {
    Json child = node_of_instance(readers, i);
    if (!has_finite_place(child)) continue;  // JSON has no number for it
    for (const char* key : {"mesh", "skin", "weights"})
      if (nodes[node].contains(key)) child[key] = nodes[node][key];
    made[i] = static_cast<int>(nodes.size());
    nodes[node]["children"].push_back(nodes.size());
    nodes.push_back(std::move(child));
  }
  for (const char* key : {"mesh", "skin", "weights"}) nodes[node].erase(key);
  for (const char* name : kSplitExtensions) remove_extension(nodes[node], name);
  return made;
}

void SourceFile::finish_splits(const std::map<int, std::vector<int>>& parts) {
  if (parts.empty()) return;
  for (const char* name : kSplitExtensions) unlist_unused_extension(content->json, name);
  animate_parts(content->json, parts);
}

PrimitiveColors SourceFile::colors(std::uint32_t mesh, std::uint32_t primitive) const {
  const auto reader = read_colors(content->document, content->primitive(mesh, primitive),
                                  primitive_label(mesh, primitive), 3);
  if (!reader) return {};
  PrimitiveColors colors{static_cast<std::uint32_t>(reader->components()), {}, false};
  colors.are_floats = reader->element_bytes() == sizeof(float) * reader->components();
  colors.values.resize(4 * reader->count(), 1.0f);
  for (std::size_t i = 0; i < reader->count(); ++i)
    for (std::uint32_t c = 0; c < colors.components; ++c)
      colors.values[4 * i + c] = reader->normalized(i, c);
  return colors;
}

std::vector<Imath::V2f> SourceFile::uvs(std::uint32_t mesh, std::uint32_t primitive,
                                        std::uint32_t set) const {
  const auto reader = read_uvs(content->document, content->primitive(mesh, primitive), set,
                               primitive_label(mesh, primitive));
  if (!reader) return {};
  std::vector<Imath::V2f> uvs(reader->count());
  for (std::size_t i = 0; i < uvs.size(); ++i) uvs[i] = reader->vec2(i);
  return uvs;
}

std::vector<Imath::V2f> SourceFile::uvs(const VertexSource& source, std::uint32_t set) const {
  const auto reader = read_uvs(content->document, content->primitive(source.mesh, source.primitive),
                               set, primitive_label(source.mesh, source.primitive));
  if (!reader) return {};
  std::vector<Imath::V2f> uvs(source.count);
  for (std::uint32_t i = 0; i < source.count; ++i)
    uvs[i] = reader->vec2(source.used.empty() ? i : source.used[i]);
  return uvs;
}

std::string SourceFile::texture_with_uvs(std::uint32_t mesh, std::uint32_t primitive,
                                         std::uint32_t set) const {
  const Json& json = content->json;
  const Json& user = json["meshes"][mesh]["primitives"][primitive];
  std::vector<std::size_t> materials;
  if (const int own = material_of(user); own != kNoMaterial)
    materials.push_back(static_cast<std::size_t>(own));
  for_each_variant(user, content->document.model.materials.size(), [&](const Json& mapping) {
    materials.push_back(mapping["material"].get<std::size_t>());
  });
  if (user.contains("extensions"))  // such as EXT_mesh_features
    if (std::string own = gltf::texture_with_uvs(user["extensions"], set); !own.empty())
      return own + " of its own extensions";
  for (const std::size_t i : materials) {
    const Json& material = json["materials"][i];
    const std::string texture = gltf::texture_with_uvs(material, set);
    if (!texture.empty())
      return fmt::format("{} of {}", texture, element("material", i, material.value("name", "")));
  }
  return {};
}

std::optional<std::uint32_t> SourceFile::occlusion_set(std::uint32_t mesh,
                                                       std::uint32_t primitive) const {
  const int material = material_of(content->json["meshes"][mesh]["primitives"][primitive]);
  if (material == kNoMaterial) return {};
  const Json& json = content->json["materials"][static_cast<std::size_t>(material)];
  if (!json.contains("occlusionTexture")) return {};
  return json["occlusionTexture"].value("texCoord", 0u);
}

bool SourceFile::is_unlit(std::uint32_t mesh, std::uint32_t primitive) const {
  const int material = material_of(content->json["meshes"][mesh]["primitives"][primitive]);
  return material != kNoMaterial &&
         has_extension(content->json["materials"][static_cast<std::size_t>(material)],
                       extension::kUnlit);
}

std::vector<std::string> SourceFile::attributes(std::uint32_t mesh, std::uint32_t primitive) const {
  std::vector<std::string> names;
  for (const auto& [name, accessor] : content->primitive(mesh, primitive).attributes)
    names.push_back(name);
  return names;
}

std::uint32_t SourceFile::uv_sets(std::uint32_t mesh, std::uint32_t primitive) const {
  std::uint32_t sets = 0;
  while (attribute(content->primitive(mesh, primitive), "TEXCOORD_" + std::to_string(sets)) >= 0)
    ++sets;
  return sets;
}

}  // namespace dapple::gltf
