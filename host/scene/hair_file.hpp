// Cem Yuksel's HAIR files (cemyuksel.com/research/hairmodels, "HAIR File Format Specification"): a
// header of 128 bytes, then arrays of segments, points, thickness, transparency and colours.
//
// Coordinates are taken as metres and as they are, whichever way is up: the format says neither,
// files are found with Y and with Z up. Thickness is a diameter, as are the widths of curves that
// exporters write there. Transparency t is opacity 1 - t of each crossing of a strand. Colours are
// left out: nothing here needs them. Strands that are no longer than thick are dropped, and
// counted.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "dapple/scene.hpp"

namespace dapple {

/// Whether a scene of that name is read by load_hair(): it ends in ".hair".
bool is_hair_name(const std::string& path);

/// One mesh of strands, one material "hair". Throws Error input.
Scene load_hair(const std::string& path);

/// The same from memory; messages begin with `path`.
Scene decode_hair(std::span<const std::uint8_t> bytes, const std::string& path);

}  // namespace dapple
