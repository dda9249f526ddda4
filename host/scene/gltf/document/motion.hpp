// Reads animations and skins from the JSON and checks their indices. In: the JSON root; out: a
// Motion. animation.hpp and deformation.hpp evaluate them at a time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace dapple::gltf {

enum class Interpolation { linear, step, cubic };
enum class MovedPart { translation, rotation, scale, weights };

/// Connects one property of a node with its keyframes.
struct Channel {
  int number = 0;  ///< its index in the animation, for messages
  int node = 0;
  MovedPart part = MovedPart::translation;
  Interpolation interpolation = Interpolation::linear;
  int times = 0;   ///< accessor
  int values = 0;  ///< accessor
};

/// One animation, without the channels that move nothing that dapple reads.
struct Clip {
  std::string name;
  std::vector<Channel> channels;
};

struct Skin {
  std::string name;
  std::vector<int> joints;    ///< nodes
  int inverse_matrices = -1;  ///< accessor; -1: identity matrices
};

struct Motion {
  std::vector<Clip> clips;
  std::vector<Skin> skins;
};

/// `root` must have passed check_schema(). Throws Error input when an index of an animation, of a
/// skin or of a node's skin names an element that does not exist.
Motion read_motion(const nlohmann::json& root, const std::string& file);

}  // namespace dapple::gltf
