// Decodes primitives, a stream after the other: see compressed_primitives.hpp.
#include "scene/gltf/document/compressed_primitives.hpp"

#include <map>
#include <tuple>
#include <utility>

#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/draco_mesh.hpp"
#include "scene/gltf/document/element_check.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

/// Memory that all streams of a scene may take to decode, for each byte of its files and at least.
/// A flat, regular grid of a million quads takes nearly this much for a byte at Draco's best.
constexpr std::uint64_t kMaxRatio = 2048, kMinMemory = std::uint64_t{1} << 28;

/// A primitive that names a stream, and its name in messages.
struct CompressedPrimitive {
  tinygltf::Primitive& primitive;
  std::string who;
};

/// The extension's object of a primitive.
const tinygltf::Value& extension_of(const tinygltf::Primitive& primitive) {
  return primitive.extensions.at(extension::kDraco);
}

class PrimitiveDecoder {
 public:
  explicit PrimitiveDecoder(Document& document)
      : document_(document),
        check_(document.file),
        memory_{kMinMemory + kMaxRatio * document.bytes} {}

  void run() {
    for (const auto& [view, users] : users_of_streams()) {
      const DracoMesh mesh(stream(view, users.front().who), memory_,
                           {document_.file, users.front().who});
      for (const CompressedPrimitive& user : users) decode(mesh, view, user);
    }
  }

 private:
  using Users = std::map<int, std::vector<CompressedPrimitive>>;

  /// By bufferView.
  Users users_of_streams() {
    Users users;
    auto& meshes = document_.model.meshes;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      for (std::size_t p = 0; p < meshes[m].primitives.size(); ++p) {
        tinygltf::Primitive& primitive = meshes[m].primitives[p];
        if (!primitive.extensions.contains(extension::kDraco) ||
            primitive.mode == TINYGLTF_MODE_POINTS)
          continue;
        std::string who = fmt::format("{} primitive {}", element("mesh", m, meshes[m].name), p);
        if (primitive.mode != TINYGLTF_MODE_TRIANGLES &&
            primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP)
          fail(document_.file, "{} is of mode {}; {} compresses triangles (4) and strips (5)", who,
               primitive.mode, extension::kDraco);
        const int view = extension_of(primitive).Get("bufferView").GetNumberAsInt();
        users[view].push_back({primitive, std::move(who)});
      }
    }
    return users;
  }

  /// The document is not validated yet.
  [[nodiscard]] std::span<const std::uint8_t> stream(int index, const std::string& who) const {
    const auto& views = document_.model.bufferViews;
    check_.index(who + " (compressed)", "bufferView", index, views.size());
    const auto& view = views[static_cast<std::size_t>(index)];
    const std::string name = fmt::format("bufferView {}", index);
    check_.index(name, "buffer", view.buffer, document_.buffers.size());
    check_.range(name, view.byteOffset + view.byteLength,
                 document_.buffers[static_cast<std::size_t>(view.buffer)].size(),
                 fmt::format("buffer {}", view.buffer));
    return view_bytes(document_, index);
  }

  void decode(const DracoMesh& mesh, int view, const CompressedPrimitive& user) {
    const tinygltf::Value& ids = extension_of(user.primitive).Get("attributes");
    for (const std::string& name : ids.Keys()) {
      const auto attribute = user.primitive.attributes.find(name);
      if (attribute == user.primitive.attributes.end()) continue;
      const std::string who = fmt::format("{} {}", user.who, excerpt(name));
      attribute->second =
          decode_attribute(mesh, view, ids.Get(name).GetNumberAsInt(), attribute->second, who);
    }
    decode_indices(mesh, view, user);
  }

  /// Returns the index of the accessor that has the values.
  int decode_attribute(const DracoMesh& mesh, int view, int id, int index, const std::string& who) {
    check_.index(who, "accessor", index, document_.model.accessors.size());
    const tinygltf::Accessor accessor = document_.model.accessors[static_cast<std::size_t>(index)];
    check_count(who, "vertices", index, mesh.vertex_count());
    const auto [known, is_new] = places_.try_emplace({view, id, index}, -1);
    if (!is_new) return known->second;
    const ElementLayout layout = element_layout(accessor);
    count_scene_bytes(document_, layout.stride * mesh.vertex_count(),
                      fmt::format("{}: {}", document_.file, who));
    Bytes bytes =
        mesh.attribute(static_cast<std::uint32_t>(id), layout,
                       static_cast<Component>(accessor.componentType), {document_.file, who});
    return known->second = put(index, accessor, std::move(bytes));
  }

  /// A strip's accessor counts the corners of strips, which Draco does not have.
  void decode_indices(const DracoMesh& mesh, int view, const CompressedPrimitive& user) {
    tinygltf::Primitive& primitive = user.primitive;
    const std::string who = user.who + " indices";
    const bool is_strip = primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP;
    const int stated = is_strip ? -1 : primitive.indices;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    if (stated >= 0) {
      check_.index(who, "accessor", stated, document_.model.accessors.size());
      require_type(document_, stated, who, {TINYGLTF_TYPE_SCALAR},
                   {Component::uint8, Component::uint16, Component::uint32});
      check_count(who, "indices", stated, mesh.index_count());
    }
    const auto [known, is_new] = places_.try_emplace({view, -1, stated}, -1);
    if (is_new) {
      count_scene_bytes(document_, sizeof(std::uint32_t) * mesh.index_count(),
                        fmt::format("{}: {}", document_.file, who));
      known->second = put(stated, indices_accessor(mesh), bytes_of(mesh.indices()));
    }
    primitive.indices = known->second;
  }

  static tinygltf::Accessor indices_accessor(const DracoMesh& mesh) {
    tinygltf::Accessor accessor;
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.type = TINYGLTF_TYPE_SCALAR;
    accessor.count = mesh.index_count();
    return accessor;
  }

  static Bytes bytes_of(const std::vector<std::uint32_t>& indices) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(indices.data());
    return {first, first + sizeof(std::uint32_t) * indices.size()};
  }

  void check_count(const std::string& who, const char* elements, int index,
                   std::uint64_t decoded) const {
    const std::uint64_t count = document_.model.accessors[static_cast<std::size_t>(index)].count;
    if (count == decoded) return;
    fail(document_.file, "{} has {} {} in accessor {}, but {} in its Draco data", who,
         grouped(count), elements, index, grouped(decoded));
  }

  /// Stores the elements of an accessor like `accessor`, in place of `index` if that has none.
  int put(int index, tinygltf::Accessor accessor, Bytes bytes) {
    tinygltf::Model& model = document_.model;
    tinygltf::BufferView view;
    view.buffer = static_cast<int>(document_.buffers.size());
    view.byteLength = bytes.size();
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.byteOffset = 0;
    accessor.sparse.isSparse = false;
    model.bufferViews.push_back(std::move(view));
    document_.storage.push_back(std::move(bytes));
    document_.buffers.push_back(document_.storage.back());
    if (index >= 0) {
      tinygltf::Accessor& stated = model.accessors[static_cast<std::size_t>(index)];
      if (stated.bufferView < 0 && !stated.sparse.isSparse) {
        stated = std::move(accessor);
        return index;
      }
    }
    model.accessors.push_back(std::move(accessor));
    return static_cast<int>(model.accessors.size() - 1);
  }

  Document& document_;
  ElementCheck check_;
  DecodingMemory memory_;
  /// By bufferView, id of the attribute (-1: indices), and the accessor that the file names.
  std::map<std::tuple<int, int, int>, int> places_;
};

}  // namespace

void decode_compressed_primitives(Document& document) { PrimitiveDecoder(document).run(); }

}  // namespace dapple::gltf
