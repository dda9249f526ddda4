// Validates the structure of a parsed document before geometry is read: indices, byte ranges, types
// and counts, in 64-bit arithmetic. In: a Document; out: an error. Defects that only reading can
// find (an index beyond the vertices, a corrupt image) are checked where the data is read.
#include <utility>

#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/element_check.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using tinygltf::Accessor;
using tinygltf::Model;

/// An accessor without a bufferView has only zeros, and a few bytes of JSON can give it any count.
/// This limits the memory that is allocated for it.
constexpr std::uint64_t kMaxZeroElements = std::uint64_t{1} << 22;

class Validator {
 public:
  explicit Validator(const Document& document)
      : document_(document), model_(document.model), check_(document.file) {}

  void run() const {
    for (std::size_t i = 0; i < model_.bufferViews.size(); ++i) check_view(i);
    for (std::size_t i = 0; i < model_.accessors.size(); ++i) check_accessor(i);
    for (std::size_t i = 0; i < model_.textures.size(); ++i) check_texture(i);
    for (std::size_t i = 0; i < document_.images.size(); ++i) {
      check_.index(fmt::format("image {}", i), "bufferView", document_.images[i].buffer_view,
                   model_.bufferViews.size());
    }
    for (std::size_t i = 0; i < model_.materials.size(); ++i) check_material(i);
    validate_meshes(document_, check_);
    validate_nodes(document_, check_);
    validate_motion(document_);
    for (std::size_t i = 0; i < model_.scenes.size(); ++i) {
      for (const int node : model_.scenes[i].nodes) {
        check_.index(fmt::format("scene {}", i), "node", node, model_.nodes.size());
      }
    }
    check_.index("the document", "scene", model_.defaultScene, model_.scenes.size());
  }

 private:
  void check_view(std::size_t i) const {
    const auto& view = model_.bufferViews[i];
    const std::string who = fmt::format("bufferView {}", i);
    check_.index(who, "buffer", view.buffer, document_.buffers.size());
    // The schema limits both to below 2^53, so that the sum cannot overflow.
    check_.range(who, view.byteOffset + view.byteLength,
                 document_.buffers[static_cast<std::size_t>(view.buffer)].size(),
                 fmt::format("buffer {}", view.buffer));
  }

  void check_accessor(std::size_t i) const {
    const Accessor& accessor = model_.accessors[i];
    const std::string who = fmt::format("accessor {}", i);
    const ElementLayout layout = element_layout(accessor);
    check_.index(who, "bufferView", accessor.bufferView, model_.bufferViews.size());
    if (accessor.bufferView >= 0) {
      check_elements(who, accessor, layout);
    } else if (accessor.count > kMaxZeroElements) {
      fail(document_.file, "{} has {} elements but no bufferView (at most {} may be zeros)", who,
           grouped(accessor.count), grouped(kMaxZeroElements));
    }
    for (const auto& [name, values] :
         {std::pair{"min", &accessor.minValues}, std::pair{"max", &accessor.maxValues}}) {
      if (values->empty() || values->size() == layout.components) continue;
      fail(document_.file, "{}: {} has {} numbers, not {}", who, name, values->size(),
           layout.components);
    }
    if (accessor.sparse.isSparse) check_sparse(who, accessor, layout);
  }

  void check_elements(const std::string& who, const Accessor& accessor,
                      const ElementLayout& layout) const {
    const auto& view = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    const std::uint64_t stride = view.byteStride != 0 ? view.byteStride : layout.stride;
    if (stride < layout.bytes) {
      fail(document_.file, "{} has elements of {} bytes in bufferView {} of byteStride {}", who,
           layout.bytes, accessor.bufferView, stride);
    }
    check_alignment(who, accessor.byteOffset, accessor.bufferView, accessor.componentType);
    // The sum is below 2^53 * 2^8 + 2^54, which fits in 64 bits.
    const std::uint64_t needs = accessor.byteOffset + (accessor.count - 1) * stride + layout.bytes;
    check_.range(who, needs, view.byteLength, fmt::format("bufferView {}", accessor.bufferView));
  }

  /// Checks the alignment that glTF 2.0, section 3.6.2.4 requires.
  void check_alignment(const std::string& who, std::uint64_t offset, int buffer_view,
                       int component_type) const {
    const std::uint64_t bytes = component_bytes(component_type);
    const auto& view = model_.bufferViews[static_cast<std::size_t>(buffer_view)];
    if (offset % bytes == 0 && (offset + view.byteOffset) % bytes == 0) return;
    fail(document_.file,
         "{} begins at byte {} of bufferView {} and {} of its buffer; its components of {} bytes "
         "must begin at multiples of that",
         who, grouped(offset), buffer_view, grouped(offset + view.byteOffset), bytes);
  }

  void check_sparse(const std::string& who, const Accessor& accessor,
                    const ElementLayout& layout) const {
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<std::uint64_t>(sparse.count);
    if (count < 1 || count > accessor.count) {
      fail(document_.file, "{} replaces {} of its {} elements (sparse.count)", who, grouped(count),
           grouped(accessor.count));
    }
    const auto type = static_cast<Component>(sparse.indices.componentType);
    if (type != Component::uint8 && type != Component::uint16 && type != Component::uint32) {
      fail(document_.file, "{} has sparse indices of componentType {}", who,
           sparse.indices.componentType);
    }
    check_sparse_range(who + " sparse.indices", sparse.indices.bufferView,
                       sparse.indices.byteOffset, sparse.indices.componentType,
                       count * component_bytes(sparse.indices.componentType));
    check_sparse_range(who + " sparse.values", sparse.values.bufferView, sparse.values.byteOffset,
                       accessor.componentType, (count - 1) * layout.stride + layout.bytes);
  }

  void check_sparse_range(const std::string& who, int view, std::int64_t offset, int component_type,
                          std::uint64_t bytes) const {
    check_.index(who, "bufferView", view, model_.bufferViews.size());
    check_alignment(who, static_cast<std::uint64_t>(offset), view, component_type);
    check_.range(who, static_cast<std::uint64_t>(offset) + bytes,
                 model_.bufferViews[static_cast<std::size_t>(view)].byteLength,
                 fmt::format("bufferView {}", view));
  }

  void check_texture(std::size_t i) const {
    const std::string who = fmt::format("texture {}", i);
    for (const int image : {model_.textures[i].source, webp_image(model_.textures[i])})
      check_.index(who, "image", image, document_.images.size());
    check_.index(who, "sampler", model_.textures[i].sampler, model_.samplers.size());
  }

  void check_material(std::size_t i) const {
    const auto& material = model_.materials[i];
    const std::string who = element("material", i, material.name);
    const auto& pbr = material.pbrMetallicRoughness;
    for (const int texture : {pbr.baseColorTexture.index, pbr.metallicRoughnessTexture.index,
                              material.normalTexture.index, material.occlusionTexture.index,
                              material.emissiveTexture.index}) {
      check_.index(who, "texture", texture, model_.textures.size());
    }
    const auto gloss = material.extensions.find(extension::kSpecularGlossiness);
    if (gloss == material.extensions.end() || !gloss->second.Has("diffuseTexture")) return;
    check_.index(who, "texture", gloss->second.Get("diffuseTexture").Get("index").GetNumberAsInt(),
                 model_.textures.size());
  }

  const Document& document_;
  const Model& model_;
  ElementCheck check_;
};

}  // namespace

void ElementCheck::index(const std::string& who, const char* kind, int index,
                         std::size_t count) const {
  if (index < 0 || static_cast<std::size_t>(index) < count) return;
  fail(file_, "{} names {} {}, but there are {}", who, kind, index, grouped(count));
}

void ElementCheck::range(const std::string& who, std::uint64_t needs, std::uint64_t has,
                         const std::string& container) const {
  if (needs <= has) return;
  fail(file_, "{} reads past {} (needs {} bytes, has {})", who, container, grouped(needs),
       grouped(has));
}

void validate(const Document& document) { Validator(document).run(); }

}  // namespace dapple::gltf
