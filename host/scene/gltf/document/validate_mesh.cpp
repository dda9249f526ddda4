// Validates meshes: the elements that primitives name exist, their accessors have a type that glTF
// allows and as many elements as there are vertices. In: a Document; out: an error.
#include <algorithm>
#include <map>

#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/element_check.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Attributes = std::map<std::string, int>;

/// Whether positions may be integers. Without the extension, an integer componentType is an error
/// in the file, and its values would not be positions.
bool is_quantized(const tinygltf::Model& model) {
  const auto has = [](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), extension::kQuantization) != names.end();
  };
  return has(model.extensionsUsed) || has(model.extensionsRequired);
}

class MeshValidator {
 public:
  MeshValidator(const Document& document, const ElementCheck& check)
      : document_(document),
        model_(document.model),
        check_(check),
        quantized_(is_quantized(model_)) {}

  void run() const {
    for (std::size_t i = 0; i < model_.meshes.size(); ++i) {
      const auto& mesh = model_.meshes[i];
      for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
        check_primitive(fmt::format("{} primitive {}", element("mesh", i, mesh.name), p),
                        mesh.primitives[p]);
      }
    }
  }

 private:
  [[nodiscard]] const tinygltf::Accessor& accessor(int index) const {
    return model_.accessors[static_cast<std::size_t>(index)];
  }

  void check_primitive(const std::string& who, const tinygltf::Primitive& primitive) const {
    check_.index(who, "material", primitive.material, model_.materials.size());
    check_.index(who, "accessor", primitive.indices, model_.accessors.size());
    check_attributes(who, primitive.attributes);
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return;
    const std::size_t vertices = accessor(position->second).count;
    check_counts(who, vertices, primitive.attributes);
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
      const std::string target = fmt::format("{} target {}", who, t);
      check_attributes(target, primitive.targets[t]);
      check_counts(target, vertices, primitive.targets[t]);
    }
  }

  void check_attributes(const std::string& who, const Attributes& attributes) const {
    for (const auto& [name, index] : attributes) {
      const std::string what = fmt::format("{} {}", who, excerpt(name));
      check_.index(what, "accessor", index, model_.accessors.size());
      check_type(name, index, what);
    }
  }

  /// Component types of the attributes that dapple reads are checked again where they are read.
  void check_type(const std::string& name, int index, const std::string& what) const {
    if (name == "NORMAL") require_shape(index, what, TINYGLTF_TYPE_VEC3);
    if (name != "POSITION") return;
    require_shape(index, what, TINYGLTF_TYPE_VEC3);
    if (accessor(index).componentType == TINYGLTF_COMPONENT_TYPE_FLOAT || quantized_) return;
    fail(document_.file, "{} is accessor {}, which is {}; only KHR_mesh_quantization allows that",
         what, index, type_name(accessor(index)));
  }

  void require_shape(int index, const std::string& what, int type) const {
    if (accessor(index).type == type) return;
    fail(document_.file, "{} is accessor {}, which is {}: not a type that it can have", what, index,
         type_name(accessor(index)));
  }

  void check_counts(const std::string& who, std::size_t vertices,
                    const Attributes& attributes) const {
    for (const auto& [name, index] : attributes) {
      const std::size_t count = accessor(index).count;
      if (count == vertices) continue;
      fail(document_.file, "{} has {} vertices, but {} of {}", who, grouped(vertices),
           grouped(count), excerpt(name));
    }
  }

  const Document& document_;
  const tinygltf::Model& model_;
  const ElementCheck& check_;
  bool quantized_;
};

}  // namespace

void validate_meshes(const Document& document, const ElementCheck& check) {
  MeshValidator(document, check).run();
}

}  // namespace dapple::gltf
