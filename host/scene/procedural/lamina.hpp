// Laminas: the thin curved blades of petals, bracts, leaves and grass, as smooth grids. In: a form
// in metres and its colours. Out: vertices with normals and colours, appended to a mesh.
#pragma once

#include <cstdint>

#include "dapple/scene.hpp"

namespace dapple {

/// Albedo along a lamina, linear RGB. `edge` and `vein` multiply it, near the margins and on the
/// furrows; 1 changes nothing.
struct LaminaColors {
  V3f base, middle, tip;
  float edge = 1, vein = 1;
};

/// A lamina grows from `base` along `along`; its upper side faces `normal`. Widths and heights are
/// shares of `half_width`, places along it shares of `length`.
struct Lamina {
  V3f base;
  V3f along;                          ///< unit
  V3f normal;                         ///< unit, at right angles to `along`
  float length = 0, half_width = 0;   ///< metres
  float base_width = 0.3f;            ///< at its base
  float tip_width = 0.4f;             ///< at its tip
  float widest = 0.6f;                ///< where it is as wide as `half_width`, in (0, 1)
  float bend_base = 0, bend_tip = 0;  ///< radians over the length, away from `normal`
  float cup = 0;                      ///< height of the margins, as a parabola
  float crease = 0;                   ///< height of the margins, as a V
  float ridges = 0;                   ///< height of the midrib and the margins over two furrows
  float roll = 0, twist = 0;          ///< slopes of the section: everywhere, and more at the tip
  float wave = 0, phase = 0;          ///< height of waves of the margins; turns where they begin
  float lobes = 0;                    ///< depth of four lobes of each margin
  float rounding = 0;  ///< share of the length by which the tip's corners end earlier
  float notches = 0;   ///< share of the length of the notches between the tip's teeth
};

/// Rows along a lamina, columns across it: 2 rows * columns triangles.
struct LaminaGrid {
  int rows = 16, columns = 8;
};

void append_lamina(Mesh& mesh, const Lamina& lamina, LaminaGrid grid, const LaminaColors& colors,
                   std::uint32_t material);

}  // namespace dapple
