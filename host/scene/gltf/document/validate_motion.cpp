// Validates animations and skins: accessors have types that glTF allows, and their lengths fit each
// other. In: a Document; out: an error. Defects that only values show (times that do not increase)
// are checked where the values are read.
#include <algorithm>

#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/element_check.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

constexpr std::initializer_list<Component> kFloat = {Component::float32};
constexpr std::initializer_list<Component> kFloatOrNormalized = {
    Component::float32, Component::int8, Component::uint8, Component::int16, Component::uint16};

class MotionValidator {
 public:
  explicit MotionValidator(const Document& document)
      : document_(document), model_(document.model) {}

  void run() const {
    const Motion& motion = document_.motion;
    for (std::size_t i = 0; i < motion.skins.size(); ++i)
      check_skin(motion.skins[i], element("skin", i, motion.skins[i].name));
    for (std::size_t i = 0; i < motion.clips.size(); ++i) {
      const std::string who = element("animation", i, motion.clips[i].name);
      for (const Channel& channel : motion.clips[i].channels)
        check_channel(channel, fmt::format("{} channel {}", who, channel.number));
    }
  }

 private:
  [[nodiscard]] std::uint64_t count_of(int accessor) const {
    return model_.accessors[static_cast<std::size_t>(accessor)].count;
  }

  void check_skin(const Skin& skin, const std::string& who) const {
    if (skin.joints.empty()) fail(document_.file, "{} has no joints", who);
    if (skin.inverse_matrices < 0) return;
    require_type(document_, skin.inverse_matrices, who + " inverseBindMatrices",
                 {TINYGLTF_TYPE_MAT4}, kFloat);
    const std::uint64_t matrices = count_of(skin.inverse_matrices);
    if (matrices >= skin.joints.size()) return;
    fail(document_.file, "{} has {} joints, but {} inverseBindMatrices (accessor {})", who,
         grouped(skin.joints.size()), grouped(matrices), skin.inverse_matrices);
  }

  void check_channel(const Channel& channel, const std::string& who) const {
    require_type(document_, channel.times, who + " input", {TINYGLTF_TYPE_SCALAR}, kFloat);
    check_values_type(channel, who + " output");
    const auto& node = model_.nodes[static_cast<std::size_t>(channel.node)];
    if (channel.part == MovedPart::weights && node.mesh < 0) return;  // no mesh: moves nothing
    if (channel.part != MovedPart::weights && node.matrix.size() == 16)
      fail(document_.file, "{} moves node {}, which has a matrix", who, channel.node);
    const std::uint64_t each = channel.interpolation == Interpolation::cubic ? 3 : 1;
    const std::uint64_t width =
        channel.part == MovedPart::weights ? morph_target_count(document_, node.mesh) : 1;
    if (width == 0) return;  // no targets: moves nothing
    const std::uint64_t keys = count_of(channel.times), values = count_of(channel.values);
    // Divides, because a product might overflow.
    if (values % (each * width) == 0 && values / (each * width) == keys) return;
    fail(document_.file, "{} has {} keyframes of {} values, but {} values (accessor {})", who,
         grouped(keys), grouped(each * width), grouped(values), channel.values);
  }

  void check_values_type(const Channel& channel, const std::string& who) const {
    switch (channel.part) {
      case MovedPart::translation:
      case MovedPart::scale:
        return require_type(document_, channel.values, who, {TINYGLTF_TYPE_VEC3}, kFloat);
      case MovedPart::rotation:
        return require_type(document_, channel.values, who, {TINYGLTF_TYPE_VEC4},
                            kFloatOrNormalized);
      case MovedPart::weights:
        return require_type(document_, channel.values, who, {TINYGLTF_TYPE_SCALAR},
                            kFloatOrNormalized);
    }
  }

  const Document& document_;
  const tinygltf::Model& model_;
};

}  // namespace

std::uint64_t morph_target_count(const Document& document, int mesh) {
  std::size_t count = 0;
  for (const auto& primitive : document.model.meshes[static_cast<std::size_t>(mesh)].primitives)
    count = std::max(count, primitive.targets.size());
  return count;
}

void validate_motion(const Document& document) { MotionValidator(document).run(); }

}  // namespace dapple::gltf
