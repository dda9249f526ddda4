// Structural validation of a parsed document, in 64-bit arithmetic, before a byte of
// geometry is read: indices, byte ranges, types and counts. What only reading can tell
// (an index beyond the vertices, a corrupt image) is checked where it is read.
#include <array>
#include <initializer_list>

#include "scene/gltf/accessor.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/message.hpp"

namespace dapple::gltf {
namespace {

using tinygltf::Accessor;
using tinygltf::Model;

/// An accessor without a bufferView is zeros, of any count that a few bytes of JSON care
/// to name: this bounds what those bytes can make us allocate.
constexpr std::uint64_t kMaxZeroElements = std::uint64_t{1} << 22;

class Validator {
 public:
  explicit Validator(const Document& document)
      : document_(document), model_(document.model), file_(document.file) {}

  void run() const {
    for (std::size_t i = 0; i < model_.bufferViews.size(); ++i) check_view(i);
    for (std::size_t i = 0; i < model_.accessors.size(); ++i) check_accessor(i);
    for (std::size_t i = 0; i < model_.textures.size(); ++i) check_texture(i);
    for (std::size_t i = 0; i < document_.images.size(); ++i) {
      check_index(fmt::format("image {}", i), "bufferView", document_.images[i].buffer_view,
                  model_.bufferViews.size());
    }
    for (std::size_t i = 0; i < model_.materials.size(); ++i) check_material(i);
    for (std::size_t i = 0; i < model_.meshes.size(); ++i) check_mesh(i);
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) check_node(i);
    for (std::size_t i = 0; i < model_.scenes.size(); ++i) {
      for (const int node : model_.scenes[i].nodes) {
        check_index(fmt::format("scene {}", i), "node", node, model_.nodes.size());
      }
    }
    check_index("the document", "scene", model_.defaultScene, model_.scenes.size());
  }

 private:
  /// `index` is -1 where the property is absent.
  void check_index(const std::string& who, const char* kind, int index, std::size_t count) const {
    if (index < 0 || static_cast<std::size_t>(index) < count) return;
    fail(file_, "{} names {} {}, but there are {}", who, kind, index, grouped(count));
  }

  void check_range(const std::string& who, std::uint64_t needs, std::uint64_t has,
                   const std::string& whom) const {
    if (needs <= has) return;
    fail(file_, "{} reads past {} (needs {} bytes, has {})", who, whom, grouped(needs),
         grouped(has));
  }

  void check_view(std::size_t i) const {
    const auto& view = model_.bufferViews[i];
    const std::string who = fmt::format("bufferView {}", i);
    check_index(who, "buffer", view.buffer, document_.buffers.size());
    // Both are below 2^53 (schema), so that the sum cannot overflow.
    check_range(who, view.byteOffset + view.byteLength,
                document_.buffers[static_cast<std::size_t>(view.buffer)].size(),
                fmt::format("buffer {}", view.buffer));
  }

  void check_accessor(std::size_t i) const {
    const Accessor& accessor = model_.accessors[i];
    const std::string who = fmt::format("accessor {}", i);
    const std::uint64_t element_bytes =
        component_bytes(accessor.componentType) * component_count(accessor.type);
    check_index(who, "bufferView", accessor.bufferView, model_.bufferViews.size());
    if (accessor.bufferView >= 0) {
      check_elements(who, accessor, element_bytes);
    } else if (accessor.count > kMaxZeroElements) {
      fail(file_, "{} has {} elements but no bufferView (at most {} may be zeros)", who,
           grouped(accessor.count), grouped(kMaxZeroElements));
    }
    if (accessor.sparse.isSparse) check_sparse(who, accessor, element_bytes);
  }

  void check_elements(const std::string& who, const Accessor& accessor,
                      std::uint64_t element_bytes) const {
    const auto& view = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    const std::uint64_t stride = view.byteStride != 0 ? view.byteStride : element_bytes;
    if (stride < element_bytes) {
      fail(file_, "{} has elements of {} bytes in bufferView {} of byteStride {}", who,
           element_bytes, accessor.bufferView, stride);
    }
    if (accessor.count == 0) return;
    // Below 2^53 * 2^8 + 2^53: fits 64 bits.
    const std::uint64_t needs = accessor.byteOffset + (accessor.count - 1) * stride + element_bytes;
    check_range(who, needs, view.byteLength, fmt::format("bufferView {}", accessor.bufferView));
  }

  void check_sparse(const std::string& who, const Accessor& accessor,
                    std::uint64_t element_bytes) const {
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<std::uint64_t>(sparse.count);
    if (count < 1 || count > accessor.count) {
      fail(file_, "{} replaces {} of its {} elements (sparse.count)", who, grouped(count),
           grouped(accessor.count));
    }
    const auto type = static_cast<Component>(sparse.indices.componentType);
    if (type != Component::uint8 && type != Component::uint16 && type != Component::uint32) {
      fail(file_, "{} has sparse indices of componentType {}", who, sparse.indices.componentType);
    }
    check_sparse_range(who + " sparse.indices", sparse.indices.bufferView,
                       sparse.indices.byteOffset,
                       count * component_bytes(sparse.indices.componentType));
    check_sparse_range(who + " sparse.values", sparse.values.bufferView, sparse.values.byteOffset,
                       count * element_bytes);
  }

  void check_sparse_range(const std::string& who, int view, int offset, std::uint64_t bytes) const {
    check_index(who, "bufferView", view, model_.bufferViews.size());
    check_range(who, static_cast<std::uint64_t>(offset) + bytes,
                model_.bufferViews[static_cast<std::size_t>(view)].byteLength,
                fmt::format("bufferView {}", view));
  }

  void check_texture(std::size_t i) const {
    const std::string who = fmt::format("texture {}", i);
    check_index(who, "image", model_.textures[i].source, document_.images.size());
    check_index(who, "sampler", model_.textures[i].sampler, model_.samplers.size());
  }

  void check_material(std::size_t i) const {
    const auto& material = model_.materials[i];
    const std::string who = element("material", i, material.name);
    const auto& pbr = material.pbrMetallicRoughness;
    for (const int texture : {pbr.baseColorTexture.index, pbr.metallicRoughnessTexture.index,
                              material.normalTexture.index, material.occlusionTexture.index,
                              material.emissiveTexture.index}) {
      check_index(who, "texture", texture, model_.textures.size());
    }
    const auto gloss = material.extensions.find("KHR_materials_pbrSpecularGlossiness");
    if (gloss == material.extensions.end() || !gloss->second.Has("diffuseTexture")) return;
    check_index(who, "texture", gloss->second.Get("diffuseTexture").Get("index").GetNumberAsInt(),
                model_.textures.size());
  }

  void check_mesh(std::size_t i) const {
    const auto& mesh = model_.meshes[i];
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      check_primitive(fmt::format("{} primitive {}", element("mesh", i, mesh.name), p),
                      mesh.primitives[p]);
    }
  }

  void check_primitive(const std::string& who, const tinygltf::Primitive& primitive) const {
    if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      fail(file_, "{} has the unknown mode {}", who, primitive.mode);
    }
    check_index(who, "material", primitive.material, model_.materials.size());
    check_index(who, "accessor", primitive.indices, model_.accessors.size());
    for (const auto& [name, accessor] : primitive.attributes) {
      check_index(fmt::format("{} {}", who, name), "accessor", accessor, model_.accessors.size());
    }
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return;
    const std::size_t vertices = model_.accessors[std::size_t(position->second)].count;
    for (const auto& [name, accessor] : primitive.attributes) {
      const std::size_t count = model_.accessors[std::size_t(accessor)].count;
      if (count == vertices) continue;
      fail(file_, "{} has {} vertices, but {} of {}", who, grouped(vertices), grouped(count), name);
    }
  }

  void check_node(std::size_t i) const {
    const auto& node = model_.nodes[i];
    const std::string who = element("node", i, node.name);
    check_index(who, "mesh", node.mesh, model_.meshes.size());
    check_index(who, "camera", node.camera, model_.cameras.size());
    for (const int child : node.children) check_index(who, "node", child, model_.nodes.size());
    const auto light = node.extensions.find("KHR_lights_punctual");
    if (light != node.extensions.end()) {
      check_index(who, "light", light->second.Get("light").GetNumberAsInt(), model_.lights.size());
    }
    const auto instancing = node.extensions.find("EXT_mesh_gpu_instancing");
    if (instancing == node.extensions.end()) return;
    const auto& attributes = instancing->second.Get("attributes");
    for (const std::string& name : attributes.Keys()) {
      check_index(fmt::format("{} instance {}", who, name), "accessor",
                  attributes.Get(name).GetNumberAsInt(), model_.accessors.size());
    }
  }

  const Document& document_;
  const Model& model_;
  const std::string& file_;
};

}  // namespace

void validate(const Document& document) { Validator(document).run(); }

}  // namespace dapple::gltf
