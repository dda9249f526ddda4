// Reads animations and skins from JSON: see motion.hpp.
#include "scene/gltf/document/motion.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

const Json& elements(const Json& object, const char* key) {
  static const Json kNone = Json::array();
  const auto found = object.find(key);
  return found == object.end() ? kNone : *found;
}

Interpolation interpolation_of(const Json& sampler) {
  const std::string word = sampler.value("interpolation", std::string("LINEAR"));
  if (word == "STEP") return Interpolation::step;
  return word == "CUBICSPLINE" ? Interpolation::cubic : Interpolation::linear;
}

MovedPart part_of(const std::string& path) {
  if (path == "rotation") return MovedPart::rotation;
  if (path == "scale") return MovedPart::scale;
  return path == "weights" ? MovedPart::weights : MovedPart::translation;
}

class MotionReader {
 public:
  MotionReader(const Json& root, const std::string& file) : root_(root), file_(file) {}

  [[nodiscard]] Motion run() const {
    Motion motion;
    const Json& skins = elements(root_, "skins");
    for (std::size_t i = 0; i < skins.size(); ++i)
      motion.skins.push_back(read_skin(skins[i], fmt::format("skin {}", i)));
    const Json& nodes = elements(root_, "nodes");
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      check_index(nodes[i], "skin", fmt::format("node {}", i), "skin", skins.size());
    }
    const Json& animations = elements(root_, "animations");
    for (std::size_t i = 0; i < animations.size(); ++i)
      motion.clips.push_back(read_clip(animations[i], fmt::format("animation {}", i)));
    return motion;
  }

 private:
  void check_index(const Json& object, const char* key, const std::string& who, const char* kind,
                   std::size_t count) const {
    const auto found = object.find(key);
    if (found == object.end() || found->get<std::size_t>() < count) return;
    fail(file_, "{} names {} {} ({}), but there are {}", who, kind, found->get<std::size_t>(), key,
         grouped(count));
  }

  [[nodiscard]] Skin read_skin(const Json& skin, const std::string& who) const {
    const std::size_t nodes = elements(root_, "nodes").size();
    check_index(skin, "inverseBindMatrices", who, "accessor", elements(root_, "accessors").size());
    check_index(skin, "skeleton", who, "node", nodes);
    Skin result{skin.value("name", std::string()), {}, skin.value("inverseBindMatrices", -1)};
    for (const Json& joint : skin["joints"]) {
      if (joint.get<std::size_t>() >= nodes) {
        fail(file_, "{} names node {} (joints), but there are {}", who, joint.get<std::size_t>(),
             grouped(nodes));
      }
      result.joints.push_back(joint.get<int>());
    }
    return result;
  }

  [[nodiscard]] Clip read_clip(const Json& animation, const std::string& who) const {
    const Json& samplers = animation["samplers"];
    const std::size_t accessors = elements(root_, "accessors").size();
    for (std::size_t i = 0; i < samplers.size(); ++i) {
      const std::string sampler = fmt::format("{} sampler {}", who, i);
      check_index(samplers[i], "input", sampler, "accessor", accessors);
      check_index(samplers[i], "output", sampler, "accessor", accessors);
    }
    Clip clip{animation.value("name", std::string()), {}};
    const Json& channels = animation["channels"];
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const Json& target = channels[i]["target"];
      const std::string channel = fmt::format("{} channel {}", who, i);
      check_index(channels[i], "sampler", channel, "sampler", samplers.size());
      check_index(target, "node", channel, "node", elements(root_, "nodes").size());
      const std::string path = target["path"].get<std::string>();
      if (!target.contains("node") || path == "pointer") continue;  // for an extension
      const Json& sampler = samplers[channels[i]["sampler"].get<std::size_t>()];
      clip.channels.push_back({static_cast<int>(i), target["node"].get<int>(), part_of(path),
                               interpolation_of(sampler), sampler["input"].get<int>(),
                               sampler["output"].get<int>()});
    }
    return clip;
  }

  const Json& root_;
  const std::string& file_;
};

}  // namespace

Motion read_motion(const Json& root, const std::string& file) {
  return MotionReader(root, file).run();
}

}  // namespace dapple::gltf
