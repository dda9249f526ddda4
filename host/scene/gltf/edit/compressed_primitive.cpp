#include "scene/gltf/edit/compressed_primitive.hpp"

#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/edit/extension_use.hpp"
#include "scene/gltf/topology.hpp"
#include "scene/gltf/vertices.hpp"

namespace dapple::gltf {
namespace {

constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125;

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

bool leave_out_of_compressed(Editor& editor, std::uint32_t mesh, std::uint32_t primitive,
                             const std::string& name) {
  // A copy: push() may move the document's arrays.
  Json json = editor.json()["meshes"][mesh]["primitives"][primitive];
  if (!has_extension(json, extension::kDraco)) return false;
  Json& compressed = json["extensions"][extension::kDraco]["attributes"];
  compressed.erase(name);
  const bool is_plain = compressed.empty();
  if (is_plain) {  // the schema of the extension wants one attribute
    const Document& document = editor.content().document;
    const tinygltf::Primitive& decoded = editor.content().primitive(mesh, primitive);
    const auto position = static_cast<std::size_t>(attribute(decoded, "POSITION"));
    json["indices"] = add_indices(editor, element_corners(document, decoded, document.file),
                                  document.model.accessors[position].count);
    json.erase("mode");  // triangles
    remove_extension(json, extension::kDraco);
  }
  editor.json()["meshes"][mesh]["primitives"][primitive] = std::move(json);
  return is_plain;
}

int decoded_accessor(const Editor& editor, std::uint32_t mesh, std::uint32_t primitive,
                     const std::string& name, int index) {
  const tinygltf::Primitive& decoded = editor.content().primitive(mesh, primitive);
  const int known = attribute(decoded, name);
  return known < 0 ? index : known;
}

std::size_t add_indices(Editor& editor, const std::vector<std::uint32_t>& indices,
                        std::size_t vertices) {
  const bool is_short = vertices < 0xffff;
  const std::vector<std::uint16_t> shorts =
      is_short ? std::vector<std::uint16_t>(indices.begin(), indices.end())
               : std::vector<std::uint16_t>{};
  const std::size_t view =
      editor.add_view(is_short ? bytes_of(shorts) : bytes_of(indices), 0, kElementArrayBuffer);
  return editor.push("accessors", {{"bufferView", view},
                                   {"componentType", is_short ? kUnsignedShort : kUnsignedInt},
                                   {"count", indices.size()},
                                   {"type", "SCALAR"}});
}

}  // namespace dapple::gltf
