// The parameters of one procedural scene, as in "leaves=50000&opacity=0.85", checked with the
// scene's table. In: text from the command line; out: a value for every parameter.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/procedural/procedural.hpp"

namespace dapple {

class ProceduralParameters {
 public:
  /// `query` is the text after the '?', or empty. Throws Error usage; the message names the scene,
  /// the key and the allowed values.
  ProceduralParameters(const ProceduralHelp& scene, std::string_view query,
                       std::optional<double> time = {});

  /// As typed, without parameters: "scene:tree".
  [[nodiscard]] const std::string& scene() const { return scene_; }
  /// The value of a parameter of the scene's table.
  [[nodiscard]] float real(std::string_view name) const;
  [[nodiscard]] std::uint32_t whole(std::string_view name) const;
  /// The time in seconds; none: the scene is at rest.
  [[nodiscard]] std::optional<double> time() const { return time_; }
  /// Whether the scene has the parameter "wind", which alone moves procedural scenes.
  [[nodiscard]] bool can_move() const { return find("wind") < table_.size(); }

 private:
  void assign(std::string_view pair);
  [[nodiscard]] std::size_t find(std::string_view name) const;  ///< size() when there is none
  [[nodiscard]] double value_of(std::string_view name) const;

  std::string scene_;
  std::vector<ProceduralParameter> table_;
  std::vector<double> values_;
  std::vector<bool> given_;
  std::optional<double> time_;
};

}  // namespace dapple
