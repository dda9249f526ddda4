#include "scene/gltf/edit/texture_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/edit/compressed_primitive.hpp"
#include "scene/gltf/edit/material_use.hpp"

namespace dapple::gltf {
namespace {

constexpr int kFloat = 5126;
constexpr int kClampToEdge = 33071;

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Copies of the elements `source` of an accessor, stored as there, with bounds if it has some.
/// `elements`: the accessor of the document that has them.
std::size_t copy_elements(Editor& editor, std::size_t accessor, int elements,
                          const std::vector<std::uint32_t>& source, bool with_bounds) {
  const AccessorReader reader(editor.content().document, elements);
  const std::size_t size = reader.element_bytes(), stride = (size + 3) / 4 * 4;
  std::string bytes(stride * source.size(), '\0');
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> low(reader.components(), kInfinity), high(reader.components(), -kInfinity);
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (const std::uint8_t* from = reader.bytes(source[i]))
      std::copy_n(from, size, bytes.begin() + static_cast<std::ptrdiff_t>(i * stride));
    for (std::size_t c = 0; c < low.size(); ++c) {
      const float value = reader.stored(source[i], c);
      if (!std::isfinite(value)) continue;  // JSON has no number for it
      low[c] = std::min(low[c], value);
      high[c] = std::max(high[c], value);
    }
  }
  for (std::size_t c = 0; c < low.size(); ++c)
    if (low[c] > high[c]) low[c] = high[c] = 0;  // none is finite
  Json json = editor.json()["accessors"][accessor];
  with_bounds = with_bounds || json.contains("min");
  for (const char* key : {"byteOffset", "sparse", "min", "max"}) json.erase(key);
  json["bufferView"] = editor.add_view(bytes, stride, kArrayBuffer);
  json["count"] = source.size();
  if (with_bounds) {
    json["min"] = low;
    json["max"] = high;
  }
  return editor.push("accessors", std::move(json));
}

std::size_t add_uvs(Editor& editor, const std::vector<Imath::V2f>& uvs) {
  const std::size_t view = editor.add_view(bytes_of(uvs), sizeof(Imath::V2f), kArrayBuffer);
  return editor.push(
      "accessors",
      {{"bufferView", view}, {"componentType", kFloat}, {"count", uvs.size()}, {"type", "VEC2"}});
}

/// Sets that the primitive lacks before its new one are 0, 0 everywhere.
void add_uv_sets(Editor& editor, const TexturedPrimitive& textured, Json& attributes) {
  const std::vector<Imath::V2f> zero(textured.uvs.size(), Imath::V2f(0, 0));
  for (std::uint32_t set = 0; set < textured.uv_set; ++set) {
    const std::string name = fmt::format("TEXCOORD_{}", set);
    if (!attributes.contains(name)) attributes[name] = add_uvs(editor, zero);
  }
  attributes[fmt::format("TEXCOORD_{}", textured.uv_set)] = add_uvs(editor, textured.uvs);
}

/// Returns whether the old ones were also compressed.
bool replace_vertices(Editor& editor, const TexturedPrimitive& textured) {
  // A copy: push() may move the document's arrays.
  Json primitive = editor.json()["meshes"][textured.mesh]["primitives"][textured.primitive];
  const auto copy = [&](Json& accessor, int elements, const std::string& name) {
    accessor = copy_elements(editor, accessor.get<std::size_t>(), elements, textured.source,
                             name == "POSITION");
  };
  for (auto& [name, accessor] : primitive["attributes"].items())
    copy(accessor,
         decoded_accessor(editor, textured.mesh, textured.primitive, name, accessor.get<int>()),
         name);
  if (primitive.contains("targets"))
    for (Json& target : primitive["targets"])
      for (auto& [name, accessor] : target.items()) copy(accessor, accessor.get<int>(), name);
  add_uv_sets(editor, textured, primitive["attributes"]);
  primitive["indices"] = add_indices(editor, textured.indices, textured.source.size());
  primitive.erase("mode");  // triangles
  const bool was_compressed = remove_extension(primitive, extension::kDraco);
  editor.json()["meshes"][textured.mesh]["primitives"][textured.primitive] = std::move(primitive);
  return was_compressed;
}

using PrimitiveIndex = std::pair<std::uint32_t, std::uint32_t>;

/// Materials with the texture, one for each material and uv set of the file. Those of
/// KHR_materials_variants are materials of their primitives too.
class OcclusionMaterials {
 public:
  OcclusionMaterials(Editor& editor, const std::vector<TexturedPrimitive>& primitives,
                     std::size_t texture)
      : editor_(editor), texture_(texture), material_count_(0) {
    if (editor.json().contains("materials")) material_count_ = editor.json()["materials"].size();
    std::map<PrimitiveIndex, std::uint32_t> uv_set;
    for (const TexturedPrimitive& p : primitives) uv_set[{p.mesh, p.primitive}] = p.uv_set;
    const Json& meshes = editor.json()["meshes"];
    for (std::uint32_t m = 0; m < meshes.size(); ++m) {
      for (std::uint32_t p = 0; p < meshes[m]["primitives"].size(); ++p) {
        const auto found = uv_set.find({m, p});
        add_user(meshes[m]["primitives"][p],
                 found == uv_set.end() ? -1 : static_cast<int>(found->second));
      }
    }
  }

  /// Gives all materials of a primitive, those of its variants too, the texture.
  void add_texture(const TexturedPrimitive& textured) {
    // A copy: push() may move the document's arrays.
    Json primitive = editor_.json()["meshes"][textured.mesh]["primitives"][textured.primitive];
    primitive["material"] = with_texture(material_of(primitive), textured.uv_set);
    for_each_variant(primitive, material_count_, [&](Json& mapping) {
      mapping["material"] = with_texture(mapping["material"].get<int>(), textured.uv_set);
    });
    editor_.json()["meshes"][textured.mesh]["primitives"][textured.primitive] =
        std::move(primitive);
  }

  [[nodiscard]] std::size_t replaced() const { return replaced_.size(); }
  [[nodiscard]] bool had_transform() const { return had_transform_; }

 private:
  void add_user(const Json& primitive, int uv_set) {
    users_[material_of(primitive)].insert(uv_set);
    for_each_variant(primitive, material_count_, [&](const Json& mapping) {
      users_[mapping["material"].get<int>()].insert(uv_set);
    });
  }

  std::size_t with_texture(int material, std::uint32_t uv_set) {
    const auto [known, is_new] = made_.try_emplace({material, uv_set}, 0);
    if (!is_new) return known->second;
    const Json occlusion = occlusion_of(material, uv_set);
    if (material != kNoMaterial && users_[material].size() == 1) {
      known->second = static_cast<std::size_t>(material);
      editor_.json()["materials"][known->second]["occlusionTexture"] = occlusion;
    } else {
      Json copy = material == kNoMaterial
                      ? Json::object()
                      : editor_.json()["materials"][static_cast<std::size_t>(material)];
      copy["occlusionTexture"] = occlusion;
      known->second = editor_.push("materials", std::move(copy));
    }
    return known->second;
  }

  /// What does not concern the coordinates of the texture before stays.
  Json occlusion_of(int material, std::uint32_t uv_set) {
    Json occlusion = {{"index", texture_}, {"texCoord", uv_set}};
    if (material == kNoMaterial) return occlusion;
    const Json& before = editor_.json()["materials"][static_cast<std::size_t>(material)];
    const auto replaced = before.find("occlusionTexture");
    if (replaced == before.end()) return occlusion;
    replaced_.insert(material);
    had_transform_ |= has_extension(*replaced, extension::kTextureTransform);
    for (const char* key : {"strength", "extras"})
      if (replaced->contains(key)) occlusion[key] = (*replaced)[key];
    return occlusion;
  }

  Editor& editor_;
  std::size_t texture_;
  std::set<int> replaced_;              ///< materials that had an occlusion texture
  bool had_transform_ = false;          ///< whether one of these textures had one
  std::size_t material_count_;          ///< of the file
  std::map<int, std::set<int>> users_;  ///< uv sets of a material's primitives; -1: not baked
  std::map<std::pair<int, std::uint32_t>, std::size_t> made_;
};

}  // namespace

std::size_t add_occlusion_texture(Editor& editor, const std::vector<TexturedPrimitive>& primitives,
                                  const std::string& png) {
  const std::size_t sampler =
      editor.push("samplers", {{"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}});
  const std::size_t texture = editor.push(
      "textures", {{"sampler", sampler}, {"source", editor.add_image(png, kOcclusionSuffix)}});
  OcclusionMaterials materials(editor, primitives, texture);
  bool removed = false;
  for (const TexturedPrimitive& textured : primitives) {
    if (!textured.source.empty()) removed |= replace_vertices(editor, textured);
    materials.add_texture(textured);
  }
  if (removed) unlist_unused_extension(editor.json(), extension::kDraco);
  if (materials.had_transform())
    unlist_unused_extension(editor.json(), extension::kTextureTransform);
  return materials.replaced();
}

}  // namespace dapple::gltf
