// Makes scene:flower: a clump of daisies on a meadow, with leaves, grass, a camera, a sun and a
// sky. In: checked parameters; out: a scene whose surfaces are smooth and coloured at their
// vertices.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "scene/procedural/flower_head.hpp"
#include "scene/procedural/mesh_shapes.hpp"
#include "scene/procedural/scenes.hpp"

namespace dapple {
namespace {

// Streams of random numbers: the heads count up from 0.
constexpr std::uint64_t kRosetteStream = 1u << 20, kGrassStream = 2u << 20,
                        kBehindStream = 3u << 20;
constexpr FlowerMaterials kMaterials;

/// Lengths below are metres for a clump of this height.
constexpr float kUsualHeight = 0.35f;

struct Clump {
  float scale = 1;   ///< over the usual height
  float spread = 0;  ///< radius of the circle of heads, metres
  std::uint32_t seed = 1;
  float turn = 0;  ///< radians, of the spiral of heads
};

V3f bezier(const V3f (&p)[4], float t) {
  const float s = 1 - t;
  return p[0] * (s * s * s) + p[1] * (3 * s * s * t) + p[2] * (3 * s * t * t) + p[3] * (t * t * t);
}

/// A place on a Vogel spiral in a plane that leans back, so that no head hides another one.
FlowerHead head_at(const Clump& clump, int i, int blooms, Pcg32& rng) {
  const float rho = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(blooms));
  const V2f around = spiral_azimuth(i, clump.turn) * rho;
  const float rise = std::min(0.72f * clump.spread, 0.13f * clump.scale);
  const V3f place(1.3f * clump.spread * around.x, rise * around.y,
                  -0.6f * clump.spread * around.y + clump.scale * rng.between(-0.03f, 0.03f));
  FlowerHead head;
  head.disc_radius = 0.0115f * clump.scale;
  head.petal_length = 0.037f * clump.scale * rng.between(0.92f, 1.08f);
  head.centre =
      V3f(place.x, place.y + clump.scale * (0.25f + rng.between(-0.012f, 0.012f)), place.z);
  // Heads look up, outwards, and to the side of the sun and the camera.
  const V3f outward = place / clump.spread;
  head.axis = (V3f(-0.15f, 0.55f, 0.8f) + outward * 0.4f + unit_vector(rng) * 0.2f).normalized();
  head.openness = rng.between(0.85f, 1.05f);
  const float shade = 0.618034f * static_cast<float>(i) + 0.3f * rng.unit();
  head.shade = shade - std::floor(shade);
  if (i >= 3 && i % 6 == 4) {
    head.openness = 0.3f;  // a bud that opens
    head.petal_length *= 0.72f;
    head.disc_radius *= 0.8f;
  }
  return head;
}

std::vector<V3f> stem_path(const Clump& clump, const FlowerHead& head, Pcg32& rng) {
  constexpr int kSegments = 40;
  const V3f end = head.centre - head.axis * (0.08f * head.disc_radius);
  const V3f foot(0.3f * end.x + clump.scale * rng.between(-0.008f, 0.008f), 0,
                 0.3f * end.z + clump.scale * rng.between(-0.008f, 0.008f));
  const V3f path[4] = {foot, foot + V3f(0, 0.45f * end.y, 0), end - head.axis * (0.36f * end.y),
                       end};
  std::vector<V3f> points;
  for (int i = 0; i <= kSegments; ++i) {
    const float x = static_cast<float>(i) / kSegments;
    points.push_back(bezier(path, x * (2 - x)));  // closer together where the stem widens
  }
  return points;
}

Lamina leaf_form(float length) {
  Lamina leaf;
  leaf.length = length;
  leaf.half_width = 0.145f * length;
  leaf.base_width = 0.16f;
  leaf.tip_width = 0.22f;
  leaf.widest = 0.62f;
  leaf.crease = 0.35f;
  leaf.wave = 0.14f;
  leaf.lobes = 0.2f;
  leaf.rounding = 0.01f;
  return leaf;
}

LaminaColors leaf_colors(float tint) {
  const V3f warm(0.24f, 0.34f, 0.07f), cool(0.12f, 0.27f, 0.06f);
  const V3f green = cool + (warm - cool) * tint;
  return {V3f(0.24f, 0.32f, 0.09f), green, green * 1.15f, 0.85f, 1};
}

/// Places a lamina that grows from `base` at an elevation above the direction `out`, horizontal.
void aim(Lamina& lamina, V3f base, V3f out, float rise) {
  lamina.base = base;
  lamina.along = (out + V3f(0, rise, 0)).normalized();
  lamina.normal = (V3f(0, 1, 0) - lamina.along * lamina.along.y).normalized();
}

void append_stem_leaves(Mesh& mesh, const Clump& clump, const std::vector<V3f>& stem, Pcg32& rng) {
  constexpr int kLeaves = 4;
  const float turn = rng.between(0, 6);
  for (int i = 0; i < kLeaves; ++i) {
    const float where = 0.08f + 0.13f * static_cast<float>(i) + rng.between(-0.02f, 0.02f);
    V2f around = spiral_azimuth(i, turn);
    // None leans far towards the camera, which would see its shaded side.
    if (around.y > 0.4f) around.y = -around.y;
    const float size = 1 - 0.16f * static_cast<float>(i);
    Lamina leaf = leaf_form(0.085f * clump.scale * size * rng.between(0.9f, 1.15f));
    aim(leaf, stem[static_cast<std::size_t>(where * static_cast<float>(stem.size()))],
        V3f(around.x, 0, around.y), rng.between(1.3f, 2.2f));
    leaf.bend_base = 0.3f;
    leaf.bend_tip = rng.between(0.9f, 1.7f);
    leaf.phase = rng.unit();
    append_lamina(mesh, leaf, {18, 6}, leaf_colors(rng.unit()), kMaterials.leaf);
  }
}

/// Leaves around the foot of the clump, long and lying outside, short and upright inside.
void append_rosette(Mesh& mesh, const Clump& clump, int leaves) {
  for (int i = 0; i < leaves; ++i) {
    Pcg32 rng(clump.seed, kRosetteStream + static_cast<std::uint64_t>(i));
    const float age = (static_cast<float>(i) + rng.unit()) / static_cast<float>(leaves);
    const V2f around = spiral_azimuth(i, rng.between(-0.3f, 0.3f));
    const V3f out(around.x, 0, around.y);
    Lamina leaf = leaf_form(clump.scale * (0.09f + 0.06f * age) * rng.between(0.9f, 1.1f));
    aim(leaf, out * (0.25f * clump.spread * (0.3f + age)) + V3f(0, 0.002f * clump.scale, 0), out,
        2.6f - 1.7f * age);
    leaf.bend_base = 0.2f;
    leaf.bend_tip = 1.5f;
    leaf.twist = rng.between(-0.2f, 0.2f);
    leaf.phase = rng.unit();
    append_lamina(mesh, leaf, {20, 6}, leaf_colors(rng.unit()), kMaterials.leaf);
  }
}

void append_grass(Mesh& mesh, const Clump& clump) {
  constexpr int kBlades = 1500;
  const float patch = std::max(clump.spread, 0.11f * clump.scale);
  for (int i = 0; i < kBlades; ++i) {
    Pcg32 rng(clump.seed, kGrassStream + static_cast<std::uint64_t>(i));
    const V2f place = unit_circle(rng) * (patch * (0.3f + 3.9f * rng.unit()));
    const V2f around = unit_circle(rng);
    Lamina blade;
    blade.length = clump.scale * rng.between(0.02f, 0.065f);
    blade.half_width = clump.scale * rng.between(0.0011f, 0.0018f);
    blade.base_width = 0.7f;
    blade.tip_width = 0.12f;
    blade.widest = 0.3f;

    aim(blade, V3f(place.x, 0, place.y), V3f(around.x, 0, around.y), rng.between(1.6f, 5.0f));
    blade.bend_base = 0.1f;
    blade.bend_tip = rng.between(0.5f, 2.0f);
    const float dry = rng.unit();
    const V3f green = V3f(0.14f, 0.26f, 0.05f) * (1 - dry) + V3f(0.27f, 0.32f, 0.09f) * dry;
    append_lamina(mesh, blade, {5, 1}, {green * 0.75f, green, green * 1.25f, 1, 1},
                  kMaterials.leaf);
  }
}

/// A flat disc out to the horizon, whose colour goes from soil to a meadow far away.
Mesh make_meadow(const Clump& clump) {
  constexpr int kRings = 14, kSides = 96;
  Mesh ground;
  ground.name = "ground";
  ground.positions.emplace_back(0.0f, 0.0f, 0.0f);
  float radius = 0.5f * clump.spread;
  for (int ring = 0; ring < kRings; ++ring, radius *= 1.9f) {
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kSides;
      ground.positions.emplace_back(radius * static_cast<float>(std::cos(angle)), 0.0f,
                                    radius * static_cast<float>(std::sin(angle)));
    }
  }
  const auto vertex = [](int ring, int side) {
    return static_cast<std::uint32_t>(1 + ring * kSides + side % kSides);
  };
  for (int side = 0; side < kSides; ++side) {
    ground.indices.insert(ground.indices.end(), {0, vertex(0, side + 1), vertex(0, side)});
    for (int ring = 1; ring < kRings; ++ring) {
      const std::uint32_t a = vertex(ring - 1, side), b = vertex(ring - 1, side + 1);
      const std::uint32_t c = vertex(ring, side + 1), d = vertex(ring, side);
      ground.indices.insert(ground.indices.end(), {a, b, c, a, c, d});
    }
  }
  ground.materials.assign(ground.indices.size() / 3, kMaterials.ground);
  const V3f soil(0.11f, 0.10f, 0.05f), meadow(0.15f, 0.22f, 0.06f), far(0.30f, 0.37f, 0.24f);
  for (const V3f& p : ground.positions) {
    const float away = p.length() / clump.spread;
    const float near = smooth_step(away / 4.0f), horizon = smooth_step(away / 200);
    ground.colors.push_back((soil * (1 - near) + meadow * near) * (1 - horizon) + far * horizon);
  }
  return ground;
}

/// Places more of the clump behind the first one, across what the camera sees there.
void place_behind(Scene& scene, const Clump& clump, int clumps) {
  for (int i = 1; i < clumps; ++i) {
    Pcg32 rng(clump.seed, kBehindStream + static_cast<std::uint64_t>(i));
    const float far = static_cast<float>(i) / static_cast<float>(clumps);
    const float away = clump.scale * (0.55f + 7 * far * far);
    const float across = 0.618034f * static_cast<float>(i);
    const float x = (2 * (across - std::floor(across)) - 1) * 0.5f * (away + clump.scale);
    const float size = rng.between(0.85f, 1.15f);
    const V2f turn = V2f(1, rng.between(-0.6f, 0.6f)).normalized() * size;
    Instance instance;
    instance.to_world = {turn.x, 0, -turn.y, 0, 0, size, 0,     0,
                         turn.y, 0, turn.x,  0, x, 0,    -away, 1};
    scene.instances.push_back(instance);
  }
}

Camera clump_camera(const Clump& clump) {
  const float s = clump.scale;
  const float back = 0.31f * s + 2.5f * clump.spread;
  Camera camera =
      look_at({0.05f * s, 0.26f * s, back}, {0.0f * s, 0.205f * s, 0}, {0, 1, 0}, 0.47f);
  camera.name = "flower";
  camera.lens_radius = 0.0035f * s;
  camera.focus_distance = back - 0.1f * clump.spread;
  return camera;
}

}  // namespace

Scene make_flower_scene(const ProceduralParameters& parameters) {
  const auto count = [&](const char* name) { return static_cast<int>(parameters.whole(name)); };
  const int blooms = count("blooms");
  const FlowerCounts counts{count("petals"), count("florets"), count("detail")};
  Clump clump;
  clump.scale = parameters.real("height") / kUsualHeight;
  clump.spread = 0.05f * clump.scale * std::sqrt(static_cast<float>(blooms));
  clump.seed = parameters.whole("seed");
  clump.turn = Pcg32(clump.seed, kRosetteStream - 1).between(0, 6.2832f);
  Mesh mesh;
  mesh.name = "flower";
  for (int i = 0; i < blooms; ++i) {
    Pcg32 rng(clump.seed, static_cast<std::uint64_t>(i));
    const FlowerHead head = head_at(clump, i, blooms, rng);
    const std::vector<V3f> stem = stem_path(clump, head, rng);
    append_flower_stem(mesh, stem, 0.0017f * clump.scale, head.disc_radius, kMaterials.stem);
    append_stem_leaves(mesh, clump, stem, rng);
    append_flower_head(mesh, head, counts, kMaterials, rng);
  }
  append_rosette(mesh, clump, count("leaves"));
  append_grass(mesh, clump);
  Scene scene;
  scene.materials = {blend_material("petal", parameters.real("opacity")), opaque_material("floret"),
                     opaque_material("leaf"), opaque_material("stem"), opaque_material("ground")};
  for (Material& material : scene.materials)
    material.color = V3f(1, 1, 1);  // the vertices have one
  place(scene, std::move(mesh));
  place_behind(scene, clump, count("clumps"));
  place(scene, make_meadow(clump));
  scene.cameras.push_back(clump_camera(clump));
  scene.lights = daylight(scene.cameras.back());
  return scene;
}

}  // namespace dapple
