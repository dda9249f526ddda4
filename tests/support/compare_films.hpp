// Small films for the comparison tests, and a function that compares two of them as `dapple
// compare` does. In: sizes, planes of pixels; out: a Film, or the Comparison of two.
#pragma once

#include <limits>

#include "compare/difference.hpp"
#include "support/files/film_files.hpp"

namespace dapple::compare_test {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// The data window begins at (10, 20), so that positions in the film differ from those in the
// window.
inline Film film_of(int width, int height, std::vector<Plane> planes) {
  Film film;
  film.width = width + 30;
  film.height = height + 30;
  film.data_window = {10, 20, 9 + width, 19 + height};
  film.planes = std::move(planes);
  return film;
}

inline std::vector<float> constant(int count, float value) {
  return std::vector<float>(static_cast<std::size_t>(count), value);
}

// Pseudo-random values in [0,1), the same on every machine.
inline std::vector<float> noise(int count, std::uint32_t seed) {
  std::vector<float> values;
  for (int i = 0; i < count; ++i) {
    seed = seed * 1664525U + 1013904223U;
    values.push_back(static_cast<float>(seed >> 8U) / 16777216.0f);
  }
  return values;
}

inline Comparison compared(const Film& a, const Film& b) {
  const LayerMatch match = match_layers(a, b);
  Comparison c{"a.exr", "b.exr",      a.data_window.width(), a.data_window.height(),
               {},      match.only_a, match.only_b};
  for (const LayerPair& pair : match.pairs) c.layers.push_back(measure(pair, a.data_window));
  return c;
}

}  // namespace dapple::compare_test
