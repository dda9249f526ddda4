// Small HAIR files for tests. In: counts, defaults and arrays; out: the bytes of a file with a
// header and the arrays that are not empty.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {

struct HairBuilder {
  std::vector<std::uint16_t> segments;  ///< number of segments, one entry per strand
  std::vector<float> points;            ///< x, y and z of each point
  std::vector<float> thickness;
  std::vector<float> transparency;
  std::vector<float> colors;
  std::uint32_t strands = 0;
  std::uint32_t default_segments = 0;
  float default_thickness = 0.5f;
  float default_transparency = 0;
  std::array<float, 3> default_color = {0.3f, 0.2f, 0.1f};
  std::uint32_t more_arrays = 0;  ///< further bits for the header's field that names the arrays

  [[nodiscard]] Bytes bytes() const {
    Bytes file = {'H', 'A', 'I', 'R'};
    append(file, strands);
    append(file, static_cast<std::uint32_t>(points.size() / 3));
    append(file, array_bits() | more_arrays);
    append(file, default_segments);
    append(file, default_thickness);
    append(file, default_transparency);
    for (const float channel : default_color) append(file, channel);
    file.resize(128, 0);
    for (const std::uint16_t count : segments) append(file, count);
    for (const auto* array : {&points, &thickness, &transparency, &colors}) {
      for (const float value : *array) append(file, value);
    }
    return file;
  }

 private:
  [[nodiscard]] std::uint32_t array_bits() const {
    return (segments.empty() ? 0u : 1u) | (points.empty() ? 0u : 2u) |
           (thickness.empty() ? 0u : 4u) | (transparency.empty() ? 0u : 8u) |
           (colors.empty() ? 0u : 16u);
  }
};

/// Two strands of three points each, (0, 0, 0) (0, 1, 0) (0, 2, 0) and the same at x = 1.
inline HairBuilder two_strands() {
  HairBuilder builder;
  builder.strands = 2;
  builder.default_segments = 2;
  builder.points = {0, 0, 0, 0, 1, 0, 0, 2, 0, 1, 0, 0, 1, 1, 0, 1, 2, 0};
  return builder;
}

}  // namespace dapple::test
