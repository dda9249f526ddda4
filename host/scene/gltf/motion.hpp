// Animations and skins: what a document says of motion, its indices known to lead somewhere. What
// they mean at a time is in animation.hpp and skin.hpp.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace dapple::gltf {

enum class Interpolation { linear, step, cubic };
enum class MovedPart { translation, rotation, scale, weights };

/// What of a node follows which keyframes.
struct Channel {
  int number = 0;  ///< its place in the animation, for messages
  int node = 0;
  MovedPart part = MovedPart::translation;
  Interpolation interpolation = Interpolation::linear;
  int times = 0;   ///< accessor
  int values = 0;  ///< accessor
};

/// Without the channels that move nothing dapple knows of.
struct Clip {
  std::string name;
  std::vector<Channel> channels;
};

struct Skin {
  std::string name;
  std::vector<int> joints;    ///< nodes
  int inverse_matrices = -1;  ///< accessor, -1: identities
};

struct Motion {
  std::vector<Clip> clips;
  std::vector<Skin> skins;
};

/// In comes a document that keeps to the schema. Throws Error input when an animation, a skin
/// or a node's skin names what is not there.
Motion read_motion(const nlohmann::json& root, const std::string& file);

}  // namespace dapple::gltf
