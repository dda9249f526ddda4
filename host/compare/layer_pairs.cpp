#include "compare/layer_pairs.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace dapple {
namespace {

using Layers = std::map<std::string, std::vector<const Plane*>>;

Layers layers_of(const Film& film, const std::string& only) {
  Layers layers;
  for (const Plane& plane : film.planes) {
    const std::string layer = layer_of(plane.channel);
    if (only.empty() || layer == only) layers[layer].push_back(&plane);
  }
  return layers;
}

const Plane* find(const std::vector<const Plane*>& planes, const std::string& channel) {
  const auto found = std::find_if(planes.begin(), planes.end(),
                                  [&](const Plane* plane) { return plane->channel == channel; });
  return found == planes.end() ? nullptr : *found;
}

// Adds the channels that are in `all` and not in `other`, or only the layer's name when no channel
// is in both.
void list_missing(const std::string& layer, const std::vector<const Plane*>& all,
                  const std::vector<const Plane*>& other, std::vector<std::string>& names) {
  std::vector<std::string> missing;
  for (const Plane* plane : all) {
    if (find(other, plane->channel) == nullptr) missing.push_back(plane->channel);
  }
  if (missing.size() == all.size()) missing = {layer};
  names.insert(names.end(), missing.begin(), missing.end());
}

bool has_all(const LayerPair& layer, const std::string& prefix, const char* letters) {
  return std::all_of(letters, letters + 3,
                     [&](char letter) { return find(layer.a, prefix + letter) != nullptr; });
}

}  // namespace

LayerMatch match_layers(const Film& a, const Film& b, const std::string& only) {
  const Layers layers_a = layers_of(a, only);
  const Layers layers_b = layers_of(b, only);
  LayerMatch match;
  for (const auto& [name, planes] : layers_a) {
    const auto other = layers_b.find(name);
    if (other == layers_b.end()) {
      match.only_a.push_back(name);
      continue;
    }
    LayerPair pair{name, {}, {}};
    for (const Plane* plane : planes) {
      const Plane* twin = find(other->second, plane->channel);
      if (twin == nullptr) continue;
      pair.a.push_back(plane);
      pair.b.push_back(twin);
    }
    list_missing(name, planes, other->second, match.only_a);
    list_missing(name, other->second, planes, match.only_b);
    if (!pair.a.empty()) match.pairs.push_back(std::move(pair));
  }
  for (const auto& [name, planes] : layers_b) {
    if (!layers_a.contains(name)) match.only_b.push_back(name);
  }
  std::stable_partition(match.pairs.begin(), match.pairs.end(),
                        [](const LayerPair& pair) { return pair.name == kMainLayer; });
  return match;
}

std::string picture_of(const LayerPair& layer) {
  const bool is_main = layer.name == kMainLayer;
  const std::string prefix = is_main ? "" : layer.name + ".";
  const bool has_triple = has_all(layer, prefix, "RGB") || has_all(layer, prefix, "XYZ");
  if (!has_triple) return layer.a.front()->channel;
  return is_main ? "" : layer.name;
}

}  // namespace dapple
