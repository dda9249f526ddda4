// Samples keyframes: see animation.hpp.
#include "scene/gltf/pose/animation.hpp"

#include <algorithm>
#include <cmath>

#include "scene/gltf/document/accessor.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Imath::V3d;
using Imath::V4d;

/// The limit of numbers that animations read. Samplers may share accessors and meshes may have many
/// targets, so a small file could otherwise cause any amount of work.
std::uint64_t max_numbers(const Document& document) {
  return (std::uint64_t{1} << 24) + document.bytes;
}

const tinygltf::Accessor& accessor_of(const Document& document, int accessor) {
  return document.model.accessors[static_cast<std::size_t>(accessor)];
}

std::string name_of(const Document& document, std::size_t clip) {
  const std::string& name = document.motion.clips[clip].name;
  return name.empty() ? fmt::format("animation_{}", clip) : one_line(name);
}

std::string label_of(const Document& document, std::size_t clip, const Channel& channel) {
  return fmt::format("{} channel {}", element("animation", clip, document.motion.clips[clip].name),
                     channel.number);
}

double last_time(const Document& document, int accessor) {
  const auto& given = accessor_of(document, accessor);
  if (!given.maxValues.empty()) return given.maxValues[0];
  if (given.sparse.isSparse) return 0;  // unknown: the values are not read for this
  const AccessorReader times(document, accessor);
  return double{times.number(times.count() - 1, 0)};
}

/// Samples the keyframes of one channel at one time. `width` is as in Player::width_of().
class ChannelSampler {
 public:
  ChannelSampler(const Document& document, const Channel& channel, const std::string& who,
                 std::size_t width, const std::vector<float>& times, double seconds)
      : document_(document),
        channel_(channel),
        who_(who),
        values_(document, channel.values),
        width_(width),
        position_(find_key(times, seconds)) {}

  void move(NodePose& node) const {
    switch (channel_.part) {
      case MovedPart::translation:
        node.translation = vec3();
        break;
      case MovedPart::rotation:
        node.rotation = rotation();
        break;
      case MovedPart::scale:
        node.scale = vec3();
        break;
      case MovedPart::weights:
        node.weights.emplace();
        for (std::size_t i = 0; i < width_; ++i) node.weights->push_back(sample(i));
    }
  }

 private:
  /// Returns component `i` of the value at a keyframe.
  [[nodiscard]] double value(std::size_t key, std::size_t i) const {
    return channel_.interpolation == Interpolation::cubic ? number(3 * key + 1, i) : number(key, i);
  }

  [[nodiscard]] bool is_between() const {
    return position_.fraction > 0 && channel_.interpolation != Interpolation::step;
  }

  /// Returns component `i` of the value at the sampled time.
  [[nodiscard]] double sample(std::size_t i) const {
    const std::size_t key = position_.key;
    const double from = value(key, i);
    if (!is_between()) return from;
    const double to = value(key + 1, i);
    if (channel_.interpolation == Interpolation::cubic)
      return cubic_spline(from, number(3 * key + 2, i), number(3 * key + 3, i), to, position_);
    return from + (to - from) * position_.fraction;
  }

  [[nodiscard]] V3d vec3() const { return {sample(0), sample(1), sample(2)}; }

  [[nodiscard]] V4d rotation() const {
    if (is_between() && channel_.interpolation == Interpolation::linear)
      return slerp(unit(key_rotation(position_.key)), unit(key_rotation(position_.key + 1)),
                   position_.fraction);
    return unit({sample(0), sample(1), sample(2), sample(3)});
  }

  [[nodiscard]] V4d key_rotation(std::size_t key) const {
    return {value(key, 0), value(key, 1), value(key, 2), value(key, 3)};
  }

  [[nodiscard]] V4d unit(const V4d& rotation) const {
    const double length = rotation.length();
    if (length > 1e-6) return rotation / length;
    fail(document_.file, "{}: the rotation at keyframe {} has length zero", who_,
         grouped(position_.key));
  }

  [[nodiscard]] double number(std::size_t element, std::size_t i) const {
    // Weights are stored as consecutive scalars, other values as vectors.
    const double value = values_.components() == 1
                             ? double{values_.normalized(element * width_ + i, 0)}
                             : double{values_.normalized(element, i)};
    if (std::isfinite(value)) return value;
    fail(document_.file, "{}: output {} (accessor {}) is not finite", who_, grouped(element),
         channel_.values);
  }

  const Document& document_;
  const Channel& channel_;
  const std::string& who_;
  AccessorReader values_;
  std::size_t width_;
  KeyframePosition position_;
};

}  // namespace

KeyframePosition find_key(const std::vector<float>& times, double seconds) {
  const auto after =
      std::upper_bound(times.begin(), times.end(), seconds,
                       [](double value, float time) { return static_cast<float>(value) < time; });
  if (after == times.begin()) return {};
  KeyframePosition position;
  position.key = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end()) return position;
  position.interval = double{*after} - double{times[position.key]};
  position.fraction = std::max(0.0, (seconds - double{times[position.key]}) / position.interval);
  return position;
}

V4d slerp(const V4d& from, V4d to, double fraction) {
  double cosine = from.dot(to);
  if (cosine < 0) {
    to = -to;
    cosine = -cosine;
  }
  // For angles below about a hundredth of a degree, linear interpolation is accurate enough and
  // avoids a division by zero.
  if (cosine > 1 - 1e-8) return (from + (to - from) * fraction).normalized();
  const double angle = std::acos(cosine);
  return (from * std::sin((1 - fraction) * angle) + to * std::sin(fraction * angle)) /
         std::sin(angle);
}

double cubic_spline(double from, double out_tangent, double in_tangent, double to,
                    const KeyframePosition& position) {
  const double t = position.fraction, t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * from + position.interval * (t3 - 2 * t2 + t) * out_tangent +
         (3 * t2 - 2 * t3) * to + position.interval * (t3 - t2) * in_tangent;
}

std::vector<Animation> list_animations(const Document& document) {
  std::vector<Animation> animations;
  for (std::size_t i = 0; i < document.motion.clips.size(); ++i) {
    double seconds = 0;
    for (const Channel& channel : document.motion.clips[i].channels)
      seconds = std::max(seconds, last_time(document, channel.times));
    animations.push_back({name_of(document, i), seconds});
  }
  return animations;
}

Player::Player(const Document& document, const std::string& animation) : document_(document) {
  choose(animation);
  std::uint64_t numbers = 0;
  for (const std::size_t clip : clips_) {
    for (const Channel& channel : document.motion.clips[clip].channels)
      read_times(label_of(document, clip, channel), channel.times, numbers);
  }
}

void Player::choose(const std::string& animation) {
  const std::size_t count = document_.motion.clips.size();
  std::string names;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = name_of(document_, i);
    if (animation == "*" || animation == name || (animation.empty() && i == 0)) clips_.push_back(i);
    if (animation == name) return;
    if (i < 20) names += (names.empty() ? "" : ", ") + excerpt(name);
  }
  if (animation.empty() || animation == "*") return;
  throw Error(ErrorKind::usage,
              fmt::format("--animation {}: {} has {}", one_line(excerpt(animation)),
                          one_line(document_.file),
                          count == 0 ? "no animations" : "only these animations: " + names));
}

void Player::count(std::uint64_t& numbers, std::uint64_t more, const std::string& who) const {
  numbers += more;
  if (numbers <= max_numbers(document_)) return;
  fail(document_.file,
       "{} brings the numbers of its motion to {} (at most {} in a scene of {} bytes)", who,
       grouped(numbers), grouped(max_numbers(document_)), grouped(document_.bytes));
}

void Player::read_times(const std::string& who, int accessor, std::uint64_t& numbers) {
  const auto [found, is_new] = times_.try_emplace(accessor);
  if (!is_new) return;
  count(numbers, accessor_of(document_, accessor).count + sparse_count(document_, accessor), who);
  const AccessorReader reader(document_, accessor);
  std::vector<float>& times = found->second;
  times.reserve(reader.count());
  for (std::uint64_t i = 0; i < reader.count(); ++i) {
    const float time = reader.number(i, 0);
    if (!std::isfinite(time) || (i > 0 && time <= times.back())) {
      fail(document_.file,
           "{}: the time of keyframe {} is {:g} (accessor {}); times must be finite and increase",
           who, grouped(i), time, accessor);
    }
    times.push_back(time);
  }
}

std::uint64_t Player::width_of(const Channel& channel) const {
  if (channel.part != MovedPart::weights) return 1;
  const int mesh = document_.model.nodes[static_cast<std::size_t>(channel.node)].mesh;
  return mesh < 0 ? 0 : morph_target_count(document_, mesh);
}

Pose Player::at(double seconds) const {
  Pose pose;
  std::uint64_t numbers = 0;
  for (const std::size_t clip : clips_) {
    for (const Channel& channel : document_.motion.clips[clip].channels) {
      const std::uint64_t width = width_of(channel);
      if (width == 0) continue;  // weights of a mesh without targets
      const std::string who = label_of(document_, clip, channel);
      count(numbers, width + sparse_count(document_, channel.values), who);
      const ChannelSampler sampler(document_, channel, who, width, times_.at(channel.times),
                                   seconds);
      sampler.move(pose[channel.node]);
    }
  }
  return pose;
}

}  // namespace dapple::gltf
