// Groups channels into layers, and matches the layers of two films by name. In: two films. Out:
// pairs of planes, which point into the films.
#pragma once

#include <string>
#include <vector>

#include "dapple/film.hpp"
#include "film/exr/exr_parts.hpp"

namespace dapple {

/// A layer that both films have. `a[i]` and `b[i]` are the same channel. The films own the planes.
struct LayerPair {
  std::string name;
  std::vector<const Plane*> a, b;

  [[nodiscard]] bool is_light() const {
    return name.starts_with("light.") || name.starts_with("beauty.");
  }
};

struct LayerMatch {
  std::vector<LayerPair> pairs;  ///< RGBA first, then by name
  /// Layers that only one film has, and single channels that only one film has in a common layer.
  std::vector<std::string> only_a, only_b;
};

/// Matches the layers of two films, which must outlive the result. With a name in `only` all other
/// layers are left out.
LayerMatch match_layers(const Film& a, const Film& b, const std::string& only = "");

/// The name by which write_png() and layer_tone() find the picture of `layer`: the layer if it has
/// RGB or XYZ, else its first channel.
std::string picture_of(const LayerPair& layer);

}  // namespace dapple
