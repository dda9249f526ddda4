// Channels grouped to layers, and the layers of two films matched by name. In: two films.
// Out: pairs of planes that point into them.
#pragma once

#include <string>
#include <vector>

#include "dapple/film.hpp"

namespace dapple {

/// One layer that both films have; `a[i]` and `b[i]` are the same channel. The planes belong
/// to the films.
struct LayerPair {
  std::string name;
  std::vector<const Plane*> a, b;

  [[nodiscard]] bool is_light() const { return name.starts_with("light."); }
};

struct LayerMatch {
  std::vector<LayerPair> pairs;  ///< RGBA first, then by name
  /// Layers that one film alone has, and single channels that it alone has in a layer of both.
  std::vector<std::string> only_a, only_b;
};

/// What precedes the last dot: "light.key" of "light.key.R". R, G, B and A are the layer
/// "RGBA"; any other channel without a dot is a layer of its own.
std::string layer_of(const std::string& channel);

/// Points into `a` and `b`.
LayerMatch match_layers(const Film& a, const Film& b);

/// What write_png and layer_tone call the picture of `layer`: its RGB or XYZ, or else its
/// first channel.
std::string picture_of(const LayerPair& layer);

}  // namespace dapple
