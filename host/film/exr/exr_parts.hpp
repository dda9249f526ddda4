// Divides a film among the parts of an EXR file. In: a film and a format. Out: for each part its
// name, its planes, their types and its compression. The writer follows it.
#pragma once

#include <string>
#include <vector>

#include "dapple/film.hpp"

namespace dapple {

struct ExrPart {
  std::string name;
  std::vector<const Plane*> planes;
  std::vector<bool> half;  ///< by plane: 16-bit floats
  bool color = false;      ///< linear colours, and not data such as normals
  ExrCompression compression = ExrCompression::zip;
};

/// One part, or a part for each layer in the order of the planes.
std::vector<ExrPart> exr_parts(const Film& film, const ExrFormat& format);

/// The names in `format.half` that no layer of the film has.
std::vector<std::string> half_layers_without_planes(const Film& film, const ExrFormat& format);

/// The layer of a channel: its name before the last dot, "light.key" for "light.key.R". R, G, B and
/// A are "RGBA"; other channels without a dot ("Z") are layers of their own.
std::string layer_of(const std::string& channel);

inline constexpr const char* kMainLayer = "RGBA";

}  // namespace dapple
