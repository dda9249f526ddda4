// A colour ramp from black, through purple and orange, to pale yellow. In: a value in [0,1]. Out:
// an RGB colour.
#pragma once

#include <array>
#include <cstdint>

namespace dapple {

using Rgb = std::array<std::uint8_t, 3>;

/// Every 17th colour of magma, by Nathaniel J. Smith and Stefan van der Walt (CC0). Its lightness
/// increases evenly, so that equal steps look equal, also in grey and to colour-blind people.
inline constexpr std::array<Rgb, 16> kHeatRamp{{{0x00, 0x00, 0x04},
                                                {0x0B, 0x09, 0x24},
                                                {0x20, 0x11, 0x4B},
                                                {0x3B, 0x0F, 0x70},
                                                {0x57, 0x15, 0x7E},
                                                {0x72, 0x1F, 0x81},
                                                {0x8C, 0x29, 0x81},
                                                {0xA8, 0x32, 0x7D},
                                                {0xC4, 0x3C, 0x75},
                                                {0xDE, 0x49, 0x68},
                                                {0xF1, 0x60, 0x5D},
                                                {0xFA, 0x7F, 0x5E},
                                                {0xFE, 0x9F, 0x6D},
                                                {0xFE, 0xBF, 0x84},
                                                {0xFD, 0xDE, 0x9F},
                                                {0xFC, 0xFD, 0xBF}}};

/// The ramp's colour at `heat`, clamped to [0,1]; NaN counts as 0.
Rgb heat_color(double heat);

}  // namespace dapple
