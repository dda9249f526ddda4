// Keyframe animation: in come a document's animations and a time, out comes a Pose. Which of them
// play is settled once: "*" for all, of which the last one that moves something decides, a name, or
// the first of the file, as viewers do.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/pose.hpp"

namespace dapple::gltf {

/// Name, or "animation_N" for one without, and length of every animation.
std::vector<Animation> list_animations(const Document& document);

/// The animations that play. Refers to the document, which must outlive it.
class Player {
 public:
  /// Throws Error usage, naming --animation and those that there are, when there is none of that
  /// name, and Error input for keyframes whose times do not increase.
  Player(const Document& document, const std::string& animation);

  /// Before the first keyframe what moves is as at the first, behind the last as at the last; all
  /// in double precision. Throws Error input, naming animation and channel, for values that are
  /// none.
  [[nodiscard]] Pose at(double seconds) const;

 private:
  void choose(const std::string& animation);
  void read_times(const std::string& who, int accessor, std::uint64_t& numbers);
  void count(std::uint64_t& numbers, std::uint64_t more, const std::string& who) const;
  /// Numbers in one value.
  [[nodiscard]] std::uint64_t width_of(const Channel& channel) const;

  const Document& document_;
  std::vector<std::size_t> clips_;           ///< that play
  std::map<int, std::vector<float>> times_;  ///< by accessor
};

/// Where `seconds` lies among keyframes at `times`: between `key` and the one after it, `fraction`
/// of the way; at the ends clamped, with a fraction of 0.
struct KeyPlace {
  std::size_t key = 0;
  double fraction = 0;
  double interval = 0;  ///< seconds from `key` to the next
};

KeyPlace find_key(const std::vector<float>& times, double seconds);

/// Spherical linear interpolation of unit quaternions, the shorter way round.
Imath::V4d slerp(const Imath::V4d& from, Imath::V4d to, double fraction);

/// glTF 2.0, appendix C.5: values with the tangents that leave the first and reach the second.
double cubic_spline(double from, double out_tangent, double in_tangent, double to,
                    const KeyPlace& place);

}  // namespace dapple::gltf
