// Keyframe animation. In: a document's animations and a time in seconds; out: a Pose. The
// animations that play are chosen once: "*" for all (when several move the same property, the last
// one wins), a name, or "" for the first of the file, as viewers do.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/pose/pose.hpp"

namespace dapple::gltf {

/// Returns name and length of every animation; one without a name is called "animation_N".
std::vector<Animation> list_animations(const Document& document);

/// The animations that play. Keeps a reference to the document, which must outlive it.
class Player {
 public:
  /// Throws Error usage when there is no animation of that name; the message lists the names that
  /// exist. Throws Error input when keyframe times are not finite or do not increase.
  Player(const Document& document, const std::string& animation);

  /// Returns the pose at a time. Before the first keyframe it is the first one's pose, after the
  /// last keyframe the last one's. Computed in double precision. Throws Error input, naming
  /// animation and channel, for values that are not finite and rotations of length zero.
  [[nodiscard]] Pose at(double seconds) const;

 private:
  void choose(const std::string& animation);
  void read_times(const std::string& who, int accessor, std::uint64_t& numbers);
  void count(std::uint64_t& numbers, std::uint64_t more, const std::string& who) const;
  /// Returns how many elements of the output accessor make one value.
  [[nodiscard]] std::uint64_t width_of(const Channel& channel) const;

  const Document& document_;
  std::vector<std::size_t> clips_;           ///< the clips that play
  std::map<int, std::vector<float>> times_;  ///< keyframe times in seconds, by accessor
};

/// The position of a time among keyframes: between `key` and the next keyframe, at `fraction` of
/// the interval. A time before the first or after the last keyframe is clamped; its fraction is 0.
struct KeyframePosition {
  std::size_t key = 0;
  double fraction = 0;
  double interval = 0;  ///< seconds from `key` to the next
};

KeyframePosition find_key(const std::vector<float>& times, double seconds);

/// Spherical linear interpolation of unit quaternions, along the shorter arc.
Imath::V4d slerp(const Imath::V4d& from, Imath::V4d to, double fraction);

/// Cubic spline of glTF 2.0, appendix C.5. `out_tangent` belongs to the value `from`, `in_tangent`
/// to the value `to`.
double cubic_spline(double from, double out_tangent, double in_tangent, double to,
                    const KeyframePosition& position);

}  // namespace dapple::gltf
