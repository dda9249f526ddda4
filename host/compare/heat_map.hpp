// Heat maps of the difference of two films. In: a layer of both. Out: an RGB image: black where
// they agree, through purple and orange to pale yellow where they differ, green for NaN and for
// infinity in one film only.
#pragma once

#include "compare/layer_pairs.hpp"
#include "film/preview/heat_color.hpp"
#include "film/preview/png.hpp"

namespace dapple {

/// The colour of pixels with NaN, or with infinity in one film only. The ramp does not contain it.
inline constexpr Rgb kNoNumberColor{0x00, 0xFF, 0x00};

/// The difference that gets the ramp's last colour: the range of values that previews show, divided
/// by `scale`. The range is 1 for AO and RGBA, the largest value in B for lights, B's range for Z
/// and P, 2 for N.
double hottest_difference(const Tone& tone_b, double scale);

/// The colour of a pixel is heat_color() of the largest |a - b| of its channels, divided by
/// `hottest`.
ByteImage heat_map(const LayerPair& layer, const PixelRect& data_window, double hottest);

}  // namespace dapple
