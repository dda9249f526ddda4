#include "scene/procedural/lamina.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "scene/procedural/mesh_shapes.hpp"

namespace dapple {
namespace {

/// Cosine of `turns` full turns, rounded once, so that libm's last bit does not change a mesh.
float wave_at(float turns) {
  return static_cast<float>(std::cos(2 * std::numbers::pi * double{turns}));
}

/// Half the width at `t` over the largest one: an S up to the widest place, then a parabola.
float width_at(const Lamina& form, float t) {
  if (t < form.widest)
    return form.base_width + (1 - form.base_width) * smooth_step(t / form.widest);
  const float q = (t - form.widest) / (1 - form.widest);
  return 1 - (1 - form.tip_width) * q * q;
}

/// The middle of a lamina at one row: a point and the axes of the section.
struct Section {
  V3f point, along, normal;
};

/// The next section, `step` of the length on: the axes turn first, and stay at right angles.
Section advance(const Section& here, float bend, float length, float step) {
  Section next;
  next.along = (here.along - here.normal * (bend * step)).normalized();
  next.normal = (here.normal - next.along * here.normal.dot(next.along)).normalized();
  next.point = here.point + (here.along + next.along).normalized() * (length * step);
  return next;
}

/// `t` in [0, 1] from the base to the tip, `u` in [-1, 1] across.
V3f surface_point(const Lamina& form, const Section& middle, float t, float u) {
  const float slope = form.roll + form.twist * t;
  const V3f flat = middle.along.cross(middle.normal);
  const V3f side = (flat + middle.normal * slope).normalized();
  const V3f up = side.cross(middle.along);
  const float lobe = 1 - form.lobes * u * u * (2 * t * (1 - t)) * (1 + wave_at(4.5f * t));
  const float half = form.half_width * width_at(form, t) * lobe;
  const float margin =
      u * u * (u < 0 ? wave_at(2.5f * t + form.phase) : wave_at(2.1f * t + form.phase + 0.4f));
  const float height = form.cup * u * u + form.crease * std::sqrt(u * u + 0.01f) +
                       form.ridges * wave_at(u) * smooth_step(3 * t) + form.wave * margin * t;
  const float early = form.rounding * u * u + form.notches * (0.5f + 0.5f * wave_at(u + 0.5f));
  return middle.point + side * (half * u) + up * (half * height) -
         middle.along * (form.length * early * t * t * t);
}

V3f color_at(const LaminaColors& colors, float t, float u) {
  const V3f color = t < 0.5f ? colors.base + (colors.middle - colors.base) * smooth_step(2 * t)
                             : colors.middle + (colors.tip - colors.middle) * (2 * t - 1);
  const float vein = 0.5f - 0.5f * wave_at(u);
  const V3f shaded = color * ((1 + (colors.edge - 1) * u * u) * (1 + (colors.vein - 1) * vein));
  return {std::min(shaded.x, 1.0f), std::min(shaded.y, 1.0f), std::min(shaded.z, 1.0f)};
}

}  // namespace

void append_lamina(Mesh& mesh, const Lamina& lamina, LaminaGrid grid, const LaminaColors& colors,
                   std::uint32_t material) {
  assert(grid.rows >= 1 && grid.columns >= 1);
  const std::size_t first = mesh.positions.size(), first_triangle = mesh.materials.size();
  const float step = 1 / static_cast<float>(grid.rows);
  Section middle{lamina.base, lamina.along, lamina.normal};
  for (int row = 0; row <= grid.rows; ++row) {
    const float t = static_cast<float>(row) * step;
    for (int column = 0; column <= grid.columns; ++column) {
      const float u = 2 * static_cast<float>(column) / static_cast<float>(grid.columns) - 1;
      mesh.positions.push_back(surface_point(lamina, middle, t, u));
      mesh.colors.push_back(color_at(colors, t, u));
    }
    const float bend = lamina.bend_base + (lamina.bend_tip - lamina.bend_base) * t;
    middle = advance(middle, bend, lamina.length, step);
  }
  append_grid_triangles(mesh, static_cast<std::uint32_t>(first), grid.rows, grid.columns, material);
  smooth_normals(mesh, first, first_triangle);
}

}  // namespace dapple
