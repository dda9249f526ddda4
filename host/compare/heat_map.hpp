// The difference of a layer as a picture: black where the films agree, through purple and
// orange to pale yellow where they differ, green where a number has no counterpart.
#pragma once

#include "compare/layers.hpp"
#include "film/heat_color.hpp"
#include "film/png.hpp"

namespace dapple {

/// NaN, or infinity against anything else: no colour of the ramp.
inline constexpr Rgb kNoNumberColor{0x00, 0xFF, 0x00};

/// The difference that gets the ramp's last colour: 1 / scale of the range that previews show
/// (1 for AO and RGBA, the largest value in B for lights, B's range for Z and P, 2 for N).
double hottest_difference(const Tone& tone_b, double scale);

/// A pixel's heat is the largest |a - b| of its channels over `hottest`.
ByteImage heat_map(const LayerPair& layer, const PixelRect& data_window, double hottest);

}  // namespace dapple
