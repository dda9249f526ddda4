#include "scene/gltf/source_file.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

#include "scene/gltf/accessor.hpp"
#include "scene/gltf/source_content.hpp"
#include "scene/gltf/vertices.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Removes kInstancing from a list of extensions if no node has it.
void remove_unused(Json& json, const char* list) {
  const bool used = std::any_of(json["nodes"].begin(), json["nodes"].end(), [](const Json& node) {
    return node.contains("extensions") && node["extensions"].contains(kInstancing);
  });
  if (used || !json.contains(list)) return;
  for (std::size_t i = json[list].size(); i-- > 0;)
    if (json[list][i] == kInstancing) json[list].erase(i);
  if (json[list].empty()) json.erase(list);
}

}  // namespace

SourceFile::SourceFile(const std::string& path, bool allow_outside)
    : content(new Content{read_file(path, path), {}, load_document(path, allow_outside), {}, 0}) {
  content->container = split_container(content->bytes, path);
  content->json = Json::parse(content->container.json);
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

bool SourceFile::has_gpu_instances(std::uint32_t node) const {
  const Json& json = content->json["nodes"][node];
  return json.contains("extensions") && json["extensions"].contains(kInstancing);
}

std::uint32_t SourceFile::split_gpu_instances(std::uint32_t node) {
  Json& nodes = content->json["nodes"];
  const Json attributes =
      nodes[node]["extensions"][kInstancing].value("attributes", Json::object());
  const auto first = static_cast<std::uint32_t>(nodes.size());
  // All have one length; without any there is one instance.
  std::size_t count = 1;
  std::map<std::string, AccessorReader> readers;
  for (const auto& [name, accessor] : attributes.items()) {
    const AccessorReader& reader =
        readers.try_emplace(name, content->document, accessor.get<int>()).first->second;
    count = reader.count();
  }
  for (std::size_t i = 0; i < count; ++i) {
    Json child = Json::object();
    for (const char* key : {"mesh", "skin", "weights"})
      if (nodes[node].contains(key)) child[key] = nodes[node][key];
    for (const auto& [name, reader] : readers) {
      const bool is_rotation = name == "ROTATION";
      std::vector<float> values;
      for (std::uint64_t c = 0; c < reader.components(); ++c)
        values.push_back(is_rotation ? reader.normalized(i, c) : reader.number(i, c));
      const bool is_place = is_rotation || name == "TRANSLATION" || name == "SCALE";
      (is_place ? child[lower_case(name)] : child["extras"][name]) = values;
    }
    nodes[node]["children"].push_back(nodes.size());
    nodes.push_back(std::move(child));
  }
  for (const char* key : {"mesh", "skin", "weights"}) nodes[node].erase(key);
  nodes[node]["extensions"].erase(kInstancing);
  if (nodes[node]["extensions"].empty()) nodes[node].erase("extensions");
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    remove_unused(content->json, list);
  return first;
}

PrimitiveColors SourceFile::colors(std::uint32_t mesh, std::uint32_t primitive) const {
  const int accessor = attribute(content->primitive(mesh, primitive), "COLOR_0");
  if (accessor < 0) return {};
  const AccessorReader reader(content->document, accessor);
  PrimitiveColors colors{static_cast<std::uint32_t>(reader.components()), {}};
  colors.values.resize(4 * reader.count(), 1.0f);
  for (std::size_t i = 0; i < reader.count(); ++i)
    for (std::uint32_t c = 0; c < colors.components; ++c)
      colors.values[4 * i + c] = reader.normalized(i, c);
  return colors;
}

std::vector<Imath::V2f> SourceFile::uvs(std::uint32_t mesh, std::uint32_t primitive,
                                        std::uint32_t set) const {
  const int accessor =
      attribute(content->primitive(mesh, primitive), "TEXCOORD_" + std::to_string(set));
  if (accessor < 0) return {};
  const AccessorReader reader(content->document, accessor);
  std::vector<Imath::V2f> uvs(reader.count());
  for (std::size_t i = 0; i < uvs.size(); ++i) uvs[i] = reader.vec2(i);
  return uvs;
}

std::uint32_t SourceFile::uv_sets(std::uint32_t mesh, std::uint32_t primitive) const {
  std::uint32_t sets = 0;
  while (attribute(content->primitive(mesh, primitive), "TEXCOORD_" + std::to_string(sets)) >= 0)
    ++sets;
  return sets;
}

}  // namespace dapple::gltf
