// Indices of animations and skins: see motion.hpp.
#include "scene/gltf/motion.hpp"

#include <nlohmann/json.hpp>

#include "scene/gltf/message.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

const Json& elements(const Json& object, const char* key) {
  static const Json kNone = Json::array();
  const auto found = object.find(key);
  return found == object.end() ? kNone : *found;
}

class MotionCheck {
 public:
  MotionCheck(const Json& root, const std::string& file) : root_(root), file_(file) {}

  void run() const {
    const Json& skins = elements(root_, "skins");
    for (std::size_t i = 0; i < skins.size(); ++i) check_skin(skins[i], fmt::format("skin {}", i));
    const Json& nodes = elements(root_, "nodes");
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      check_index(nodes[i], "skin", fmt::format("node {}", i), "skin", skins.size());
    }
    const Json& animations = elements(root_, "animations");
    for (std::size_t i = 0; i < animations.size(); ++i) {
      check_animation(animations[i], fmt::format("animation {}", i));
    }
  }

 private:
  void check_index(const Json& object, const char* key, const std::string& who, const char* kind,
                   std::size_t count) const {
    const auto found = object.find(key);
    if (found == object.end() || found->get<std::size_t>() < count) return;
    fail(file_, "{} names {} {} ({}), but there are {}", who, kind, found->get<std::size_t>(), key,
         grouped(count));
  }

  void check_skin(const Json& skin, const std::string& who) const {
    const std::size_t nodes = elements(root_, "nodes").size();
    check_index(skin, "inverseBindMatrices", who, "accessor", elements(root_, "accessors").size());
    check_index(skin, "skeleton", who, "node", nodes);
    for (const Json& joint : skin["joints"]) {
      if (joint.get<std::size_t>() < nodes) continue;
      fail(file_, "{} names node {} (joints), but there are {}", who, joint.get<std::size_t>(),
           grouped(nodes));
    }
  }

  void check_animation(const Json& animation, const std::string& who) const {
    const Json& samplers = animation["samplers"];
    const std::size_t accessors = elements(root_, "accessors").size();
    for (std::size_t i = 0; i < samplers.size(); ++i) {
      const std::string sampler = fmt::format("{} sampler {}", who, i);
      check_index(samplers[i], "input", sampler, "accessor", accessors);
      check_index(samplers[i], "output", sampler, "accessor", accessors);
    }
    const Json& channels = animation["channels"];
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const std::string channel = fmt::format("{} channel {}", who, i);
      check_index(channels[i], "sampler", channel, "sampler", samplers.size());
      check_index(channels[i]["target"], "node", channel, "node", elements(root_, "nodes").size());
    }
  }

  const Json& root_;
  const std::string& file_;
};

}  // namespace

void check_motion(const Json& root, const std::string& file) { MotionCheck(root, file).run(); }

}  // namespace dapple::gltf
