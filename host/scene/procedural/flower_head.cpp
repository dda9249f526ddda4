#include "scene/procedural/flower_head.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scene/procedural/mesh_shapes.hpp"

namespace dapple {
namespace {

constexpr float kDomeHeight = 0.42f;  ///< of the florets' dome over its radius
constexpr std::array<V3f, 3> kDeepRose{V3f(0.90f, 0.60f, 0.55f), V3f(0.70f, 0.085f, 0.22f),
                                       V3f(0.50f, 0.025f, 0.15f)};
constexpr std::array<V3f, 3> kPalePink{V3f(0.92f, 0.78f, 0.62f), V3f(0.84f, 0.32f, 0.37f),
                                       V3f(0.76f, 0.16f, 0.29f)};

V3f blend(V3f a, V3f b, float t) { return a + (b - a) * t; }

/// Axes of a head: `u` and `v` span its disc.
struct HeadAxes {
  V3f u, v, w;
  explicit HeadAxes(V3f axis) : u(perpendicular(axis)), v(axis.cross(u)), w(axis) {}
  [[nodiscard]] V3f radial(V2f turn) const { return u * turn.x + v * turn.y; }
};

/// Cosine and sine of `part` of a full turn, and of an elevation in radians.
V2f turn_of(float part) {
  const double angle = 2 * std::numbers::pi * double{part};
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

V2f elevation_of(float radians) {
  return {static_cast<float>(std::cos(double{radians})),
          static_cast<float>(std::sin(double{radians}))};
}

LaminaColors petal_colors(float shade, float fade) {
  LaminaColors colors;
  colors.base = blend(kDeepRose[0], kPalePink[0], shade);
  colors.middle = blend(kDeepRose[1], kPalePink[1], shade) * fade;
  colors.tip = blend(kDeepRose[2], kPalePink[2], shade) * fade;
  colors.edge = 1.12f;
  colors.vein = 0.78f;
  return colors;
}

/// One of two whorls; the inner one is shorter and stands steeper.
struct Whorl {
  int petals = 0;
  float length = 0, radius = 0, height = 0, elevation = 0, offset = 0;
};

void append_whorl(Mesh& mesh, const FlowerHead& head, const Whorl& whorl, int detail,
                  std::uint32_t material, Pcg32& rng) {
  const HeadAxes axes(head.axis);
  // As wide as their room on the circle, where they are widest, and a little more.
  const float room = std::numbers::pi_v<float> * (whorl.radius + 0.6f * whorl.length) /
                     static_cast<float>(whorl.petals);
  for (int i = 0; i < whorl.petals; ++i) {
    const float where =
        (static_cast<float>(i) + rng.between(-0.12f, 0.12f)) / static_cast<float>(whorl.petals);
    const V3f out = axes.radial(turn_of(where + whorl.offset));
    const V2f rise = elevation_of(whorl.elevation + rng.between(-0.07f, 0.07f));
    Lamina petal;
    petal.base = head.centre + out * whorl.radius + axes.w * whorl.height;
    petal.along = out * rise.x + axes.w * rise.y;
    petal.normal = axes.w * rise.x - out * rise.y;
    petal.length = whorl.length * rng.between(0.93f, 1.05f);
    petal.half_width = std::min(1.12f * room, 0.36f * whorl.length) * rng.between(0.94f, 1.04f);
    petal.base_width = 0.42f;
    petal.tip_width = 0.5f;
    petal.widest = 0.62f;
    petal.bend_base = 0.25f;
    petal.bend_tip = (0.75f + rng.between(-0.25f, 0.35f)) * (0.25f + 0.75f * head.openness);
    petal.cup = rng.between(0.10f, 0.24f);
    petal.ridges = 0.05f;
    petal.roll = 0.16f;  // each petal lies on its neighbour, all around
    petal.twist = rng.between(-0.08f, 0.12f);
    petal.wave = rng.between(0.03f, 0.10f);
    petal.phase = rng.unit();
    petal.rounding = 0.055f;
    petal.notches = 0.02f;
    append_lamina(mesh, petal, {5 * detail / 2, detail},
                  petal_colors(head.shade, rng.between(0.92f, 1.06f)), material);
  }
}

void append_petals(Mesh& mesh, const FlowerHead& head, const FlowerCounts& counts,
                   std::uint32_t material, Pcg32& rng) {
  const float closed = 1 - head.openness;
  Whorl outer;
  outer.petals = (5 * counts.petals + 7) / 8;  // 13 of 21
  outer.length = head.petal_length;
  outer.radius = 0.80f * head.disc_radius;
  outer.height = -0.10f * head.disc_radius;
  outer.elevation = 0.22f + 1.0f * closed;
  append_whorl(mesh, head, outer, counts.detail, material, rng);
  Whorl inner = outer;
  inner.petals = counts.petals - outer.petals;
  if (inner.petals == 0) return;
  inner.length = 0.86f * head.petal_length;
  inner.radius = 0.84f * head.disc_radius;
  inner.height = 0.02f * head.disc_radius;
  inner.elevation = 0.38f + 0.95f * closed;
  inner.offset = 0.5f / static_cast<float>(outer.petals);
  append_whorl(mesh, head, inner, counts.detail, material, rng);
}

/// A bud, or an open floret that widens upwards. `axis` is unit; `width` is its radius.
void append_floret(Mesh& mesh, V3f foot, V3f axis, float width, float length, bool is_open,
                   std::uint32_t material) {
  const std::size_t vertex = mesh.positions.size(), triangle = mesh.materials.size();
  const std::array<V3f, 4> points{foot, foot + axis * (0.55f * length),
                                  foot + axis * (is_open ? length : 0.88f * length),
                                  foot + axis * (is_open ? 1.05f * length : length)};
  const std::array<float, 4> radii{(is_open ? 0.6f : 0.95f) * width, (is_open ? 0.75f : 1) * width,
                                   (is_open ? 1.0f : 0.6f) * width, 0};
  append_tube(mesh, points, radii, 6, material);
  smooth_normals(mesh, vertex, triangle);
}

/// Florets stand at the points of a Fermat spiral (Vogel, A Better Way to Construct the Sunflower
/// Head, 1979) on a dome that is a paraboloid.
void append_florets(Mesh& mesh, const FlowerHead& head, int count, std::uint32_t material,
                    Pcg32& rng) {
  const HeadAxes axes(head.axis);
  const float radius = head.disc_radius, height = kDomeHeight * radius;
  const float width = 0.95f * radius / std::sqrt(static_cast<float>(count));
  for (int i = 0; i < count; ++i) {
    const float rho = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
    const V3f out = axes.radial(spiral_azimuth(i, 0));
    const V3f axis =
        (axes.w * radius + out * (2 * height * rho) + unit_vector(rng) * (0.12f * radius))
            .normalized();
    const bool is_open = rho > 0.66f;
    const float length = width * (is_open ? 4.2f : 2.9f) * rng.between(0.9f, 1.1f);
    const V3f top = head.centre + out * (radius * rho) + axes.w * (height * (1 - rho * rho));
    append_floret(mesh, top - axis * (0.5f * length), axis, width, length, is_open, material);
    const V3f color = is_open ? blend({0.80f, 0.40f, 0.015f}, {0.90f, 0.55f, 0.05f}, rng.unit())
                              : blend({0.42f, 0.34f, 0.03f}, {0.78f, 0.38f, 0.012f}, rho / 0.66f);
    mesh.colors.resize(mesh.positions.size(), color);
  }
}

/// What is between the florets: dark, and as smooth as the dome.
void append_dome(Mesh& mesh, const FlowerHead& head, std::uint32_t material) {
  constexpr int kRings = 5;
  const std::size_t vertex = mesh.positions.size(), triangle = mesh.materials.size();
  std::vector<V3f> points;
  std::vector<float> radii;
  for (int i = 0; i <= kRings; ++i) {
    const float z = static_cast<float>(i) / kRings;
    points.push_back(head.centre + head.axis * (head.disc_radius * (kDomeHeight * z - 0.06f)));
    radii.push_back(head.disc_radius * std::sqrt(1 - z));
  }
  append_tube(mesh, points, radii, 24, material);
  smooth_normals(mesh, vertex, triangle);
  mesh.colors.resize(mesh.positions.size(), V3f(0.30f, 0.13f, 0.01f));
}

void append_bracts(Mesh& mesh, const FlowerHead& head, std::uint32_t material, Pcg32& rng) {
  constexpr int kBracts = 26;
  const HeadAxes axes(head.axis);
  for (int i = 0; i < kBracts; ++i) {
    const bool is_outer = i % 2 == 0;
    const V3f out =
        axes.radial(turn_of((static_cast<float>(i) + rng.between(-0.2f, 0.2f)) / kBracts));
    const V2f rise = elevation_of(is_outer ? 0.55f : 0.7f);
    Lamina bract;
    bract.base = head.centre + out * (0.42f * head.disc_radius) -
                 axes.w * (head.disc_radius * (is_outer ? 0.78f : 0.66f));
    bract.along = out * rise.x + axes.w * rise.y;
    bract.normal = axes.w * rise.x - out * rise.y;
    bract.length = head.disc_radius * (is_outer ? 0.85f : 1.0f);
    bract.half_width = 0.19f * head.disc_radius;
    bract.base_width = 0.8f;
    bract.tip_width = 0.22f;
    bract.widest = 0.35f;
    bract.bend_base = -0.3f;
    bract.bend_tip = 0.7f;
    bract.cup = 0.3f;
    bract.rounding = 0.05f;
    append_lamina(
        mesh, bract, {6, 2},
        {V3f(0.24f, 0.34f, 0.08f), V3f(0.18f, 0.30f, 0.07f), V3f(0.26f, 0.22f, 0.10f), 1.15f, 1},
        material);
  }
}

}  // namespace

void append_flower_head(Mesh& mesh, const FlowerHead& head, const FlowerCounts& counts,
                        const FlowerMaterials& materials, Pcg32& rng) {
  append_petals(mesh, head, counts, materials.petal, rng);
  append_dome(mesh, head, materials.floret);
  append_florets(mesh, head, counts.florets, materials.floret, rng);
  append_bracts(mesh, head, materials.leaf, rng);
}

void append_flower_stem(Mesh& mesh, const std::vector<V3f>& points, float radius, float head_radius,
                        std::uint32_t material) {
  constexpr int kSides = 14;
  const std::size_t vertex = mesh.positions.size(), triangle = mesh.materials.size();
  std::vector<float> radii;
  for (const V3f& point : points) {
    const float below = (points.back() - point).length() / head_radius;
    const float height = point.y / points.back().y;
    radii.push_back(radius * (1.15f - 0.3f * height) +
                    (0.88f * head_radius - radius) * smooth_step(1.25f - below));
  }
  append_tube(mesh, points, radii, kSides, material);
  smooth_normals(mesh, vertex, triangle);
  for (std::size_t v = vertex; v < mesh.positions.size(); ++v) {
    const float height = std::clamp(mesh.positions[v].y / points.back().y, 0.0f, 1.0f);
    mesh.colors.push_back(blend({0.26f, 0.22f, 0.09f}, {0.20f, 0.32f, 0.08f}, height));
  }
}

}  // namespace dapple
