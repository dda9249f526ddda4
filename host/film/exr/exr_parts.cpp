#include "film/exr/exr_parts.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "dapple/error.hpp"
#include "scene/check/enumerator.hpp"

namespace dapple {
namespace {

constexpr const char* kAll = "all";

/// Distances, positions and numbers: 16 bits would round them visibly, or to other numbers.
bool must_stay_float(const std::string& layer) {
  constexpr std::array<std::string_view, 4> kFloat = {"Z", "P", "samples", "motion"};
  return std::find(kFloat.begin(), kFloat.end(), layer) != kFloat.end() ||
         layer.starts_with("crypto_");
}

bool is_color(const std::string& layer) {
  return layer == kMainLayer || layer == "albedo" || layer.starts_with("light.") ||
         layer.starts_with("beauty.");
}

/// Whether `name` means the layer: "light" means all of "light.NAME".
bool names_layer(const std::string& name, const std::string& layer) {
  return layer == name || layer.starts_with(name + ".");
}

bool is_half(const std::string& layer, const ExrFormat& format) {
  if (must_stay_float(layer)) return false;
  return std::any_of(format.half.begin(), format.half.end(), [&](const std::string& name) {
    return name == kAll || names_layer(name, layer);
  });
}

void add_plane(ExrPart& part, const Plane& plane, const ExrFormat& format) {
  part.planes.push_back(&plane);
  part.half.push_back(is_half(layer_of(plane.channel), format));
}

}  // namespace

void validate(const ExrFormat& format) {
  for (const std::string& name : format.half) {
    if (!must_stay_float(name)) continue;
    throw Error(ErrorKind::usage, "--half " + name + ": this layer stays 32-bit");
  }
  if (!is_enumerator(format.compression, ExrCompression::dwaa))
    throw Error(ErrorKind::usage, "--compression has no value " +
                                      std::to_string(static_cast<int>(format.compression)));
  if (format.compression != ExrCompression::dwaa || format.multipart) return;
  throw Error(ErrorKind::usage,
              "--compression dwaa needs --multipart: it is lossy, and normals, depths and ids keep "
              "their values only in parts of their own");
}

std::vector<std::string> half_layers_without_planes(const Film& film, const ExrFormat& format) {
  std::vector<std::string> names;
  for (const std::string& name : format.half) {
    const bool found = std::any_of(film.planes.begin(), film.planes.end(), [&](const Plane& plane) {
      return names_layer(name, layer_of(plane.channel));
    });
    if (!found && name != kAll) names.push_back(name);
  }
  return names;
}

std::string layer_of(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  if (dot != std::string::npos && dot > 0) return channel.substr(0, dot);
  const bool is_main = channel == "R" || channel == "G" || channel == "B" || channel == "A";
  return is_main ? kMainLayer : channel;
}

std::vector<ExrPart> exr_parts(const Film& film, const ExrFormat& format) {
  std::vector<ExrPart> parts;
  for (const Plane& plane : film.planes) {
    const std::string layer = layer_of(plane.channel);
    auto part = std::find_if(parts.begin(), parts.end(), [&](const ExrPart& each) {
      return !format.multipart || each.name == layer;
    });
    if (part == parts.end()) {
      parts.emplace_back();
      part = parts.end() - 1;
      part->name = layer;
      part->color = !format.multipart || is_color(layer);
      const bool lossy = format.compression == ExrCompression::dwaa;
      part->compression = lossy && !part->color ? ExrCompression::zip : format.compression;
    }
    add_plane(*part, plane, format);
  }
  return parts;
}

}  // namespace dapple
