// Reads Cem Yuksel's HAIR files (cemyuksel.com/research/hairmodels, "HAIR File Format
// Specification"): a header of 128 bytes, then arrays of segments, points, thickness, transparency
// and colours. In: a path or bytes; out: a scene with one mesh of strands.
//
// Coordinates are metres and stay as they are: the format gives neither unit nor up axis, and some
// files have Y up, others Z up. Thickness is a diameter; exporters write the widths of curves
// there. A transparency t means that each crossing of a strand has the opacity 1 - t. Colours are
// ignored. A strand that is no longer than it is thick is dropped; a warning gives the count.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "dapple/scene.hpp"

namespace dapple {

/// Whether load_hair() reads a scene of that name: the name ends in ".hair".
bool is_hair_name(const std::string& path);

/// Returns one mesh of strands with one material "hair". Throws Error input, and Error failed when
/// there is not enough memory.
Scene load_hair(const std::string& path);

/// Warns that the hair of a file does not move, if a time is given.
void add_time_warning(const std::string& path, std::optional<double> seconds, Scene& scene);

/// Like load_hair(), but from memory; messages begin with `path`. Throws Error input.
Scene decode_hair(std::span<const std::uint8_t> bytes, const std::string& path);

}  // namespace dapple
