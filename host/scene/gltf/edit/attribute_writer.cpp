#include "scene/gltf/edit/attribute_writer.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/document/found.hpp"
#include "scene/gltf/edit/compressed_primitive.hpp"
#include "scene/gltf/edit/extension_use.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

constexpr int kFloat = 5126, kUnsignedShort = 5123;

const char* type_of(std::uint32_t components) {
  constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return kTypes[components - 1];
}

void append(std::string& bytes, const void* data, std::size_t count) {
  bytes.append(static_cast<const char*>(data), count);
}

std::uint16_t normalized16(float value) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 65535.0f));
}

/// Values as bytes; elements begin at multiples of four bytes. Returns the stride.
std::size_t store(const NewAttribute& attribute, std::string& bytes) {
  if (attribute.storage == Storage::float32) {
    append(bytes, attribute.values.data(), attribute.values.size() * sizeof(float));
    return attribute.components * sizeof(float);
  }
  const std::size_t stride = (2 * attribute.components + 3) / 4 * 4;
  for (std::size_t i = 0; i < attribute.values.size(); i += attribute.components) {
    for (std::size_t c = 0; c < attribute.components; ++c) {
      const std::uint16_t value = normalized16(attribute.values[i + c]);
      append(bytes, &value, sizeof value);
    }
    bytes.append(stride - 2 * attribute.components, '\0');
  }
  return stride;
}

std::size_t add_accessor(Editor& editor, const NewAttribute& attribute, bool of_vertices) {
  std::string bytes;
  const std::size_t stride = store(attribute, bytes);
  const std::size_t view =
      of_vertices ? editor.add_view(bytes, stride, kArrayBuffer) : editor.add_view(bytes);
  const bool whole = attribute.storage == Storage::normalized16;
  Json accessor = {{"bufferView", view},
                   {"componentType", whole ? kUnsignedShort : kFloat},
                   {"count", attribute.values.size() / attribute.components},
                   {"type", type_of(attribute.components)}};
  if (whole) accessor["normalized"] = true;
  return editor.push("accessors", std::move(accessor));
}

/// Makes room for named values in a node's extras, which may be any JSON. Returns whether another
/// value was there, which becomes extras.value.
bool keep_other_extras(Json& node) {
  if (!node.contains("extras") || node["extras"].is_object()) return false;
  Json other = std::move(node["extras"]);
  node["extras"] = Json::object();
  if (other.is_null()) return false;
  node["extras"]["value"] = std::move(other);
  return true;
}

}  // namespace

void add_attributes(Editor& editor, const std::vector<NewAttribute>& attributes) {
  bool removed = false;
  std::map<std::pair<std::size_t, std::string>, std::size_t> stored;
  for (const NewAttribute& attribute : attributes) {
    const auto [at, is_new] = stored.try_emplace({attribute.shared, attribute.name}, 0);
    if (is_new) at->second = add_accessor(editor, attribute, true);
    Json& primitive = editor.json()["meshes"][attribute.mesh]["primitives"][attribute.primitive];
    primitive["attributes"][attribute.name] = at->second;
    removed |= leave_out_of_compressed(editor, attribute.mesh, attribute.primitive, attribute.name);
  }
  if (removed) unlist_unused_extension(editor.json(), extension::kDraco);
}

std::vector<std::string> add_node_values(Editor& editor, const std::vector<NodeValues>& nodes) {
  Found kept, replaced;
  std::set<std::uint32_t> noted;
  for (const NodeValues& values : nodes) {
    Json& node = editor.json()["nodes"][values.node];
    if (has_extension(node, extension::kInstancing)) {
      NewAttribute attribute;
      attribute.values = values.values;
      attribute.components = values.components;
      const std::size_t accessor = add_accessor(editor, attribute, false);
      editor.json()["nodes"][values.node]["extensions"][extension::kInstancing]["attributes"]
                   [values.attribute] = accessor;
    } else {
      const std::string who = element("node", values.node, node.value("name", ""));
      kept.add(keep_other_extras(node) ? 1 : 0, who);
      if (node["extras"].contains(values.extra) && noted.insert(values.node).second)
        replaced.add(1, who);
      Json& extra = node["extras"][values.extra];
      extra = values.values;
      if (values.components == 1) extra = values.values.at(0);
    }
  }
  return {kept.note("has extras that are not an object; they are kept as extras.value"),
          replaced.note("had baked values in its extras, which are replaced")};
}

}  // namespace dapple::gltf
