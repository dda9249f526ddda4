// Makes plants of other habits than scene:tree: a palm, a conifer, a weeping willow, a field of
// grass. In: checked parameters; out: a scene of blades on stems.
#include <algorithm>
#include <cmath>

#include "scene/procedural/scenes.hpp"
#include "scene/procedural/stems.hpp"
#include "scene/procedural/tree_skeleton.hpp"
#include "scene/procedural/tree_wood.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kLeaf = 0, kBark = 1;
constexpr std::uint64_t kStemStream = 0x7374656d73ULL;  // above the streams of blades

/// The mean blade length, metres: `usual` for `usual_count` blades, and such that more have the
/// same area; or the one asked for.
float blade_length(const ProceduralParameters& parameters, float usual, float usual_count) {
  if (const float given = given_leaf_length(parameters); given > 0) return given;
  constexpr float kMost = 25;  // times the usual length, where there are few blades
  return usual *
         std::min(kMost, std::sqrt(usual_count / static_cast<float>(parameters.whole("leaves"))));
}

Scene scene_of_plant(const ProceduralParameters& parameters, Mesh mesh, const char* name) {
  Scene scene;
  scene.materials = {blend_material("leaf", parameters.real("opacity")), opaque_material("bark")};
  mesh.name = name;
  place(scene, std::move(mesh));
  return scene;
}

std::vector<Stem> grow_fronds(V3f crown, float height, Pcg32& rng) {
  constexpr int kFronds = 34;
  std::vector<Stem> fronds;
  for (int i = 0; i < kFronds; ++i) {
    // Young fronds stand upright, old ones hang.
    const float age = (static_cast<float>(i) + 0.5f) / kFronds;
    const V2f around = spiral_azimuth(i, rng.between(-0.2f, 0.2f));
    const float rise = 1.2f - 1.9f * age + rng.between(-0.1f, 0.1f);
    const V3f direction = V3f(around.x, rise, around.y).normalized();
    const float length = height * 0.3f * rng.between(0.85f, 1.15f);
    fronds.push_back(grow_stem(crown, direction, length, 14, V3f(0, -0.09f - 0.05f * age, 0)));
  }
  return fronds;
}

/// Both sides of a branch, in its plane, shorter towards its tip.
void grow_side_twigs(const Stem& branch, float height, Pcg32& rng, std::vector<Stem>& twigs) {
  const V3f foot = branch.points.front(), tip = branch.points.back();
  const V3f along = (tip - foot).normalized();
  const V3f side = along.cross(V3f(0, 1, 0)).normalized();
  const float length = (tip - foot).length(), step = 0.012f * height;
  for (float s = 2 * step; s < length; s += step) {
    for (const float hand : {1.0f, -1.0f}) {
      const V3f direction = (side * hand + along * 0.9f + unit_vector(rng) * 0.25f).normalized();
      const float reach = std::max(0.5f * (length - s), step) * rng.between(0.7f, 1.1f);
      twigs.push_back(
          grow_stem(foot + (tip - foot) * (s / length), direction, reach, 3, V3f(0, -0.05f, 0)));
    }
  }
}

struct ConiferStems {
  std::vector<Stem> branches, twigs;
};

ConiferStems grow_whorls(float height, Pcg32& rng) {
  ConiferStems stems;
  int around = 0;
  for (float t = 0.08f; t < 0.97f; t += 0.027f) {
    for (int i = 0; i < 6; ++i) {
      const V2f turn = spiral_azimuth(around++, rng.between(-0.3f, 0.3f));
      const float rise = -0.2f + 0.8f * t * t + rng.between(-0.06f, 0.06f);
      const V3f direction = V3f(turn.x, rise, turn.y).normalized();
      const float length = height * (0.015f + 0.25f * (1 - t)) * rng.between(0.8f, 1.1f);
      stems.branches.push_back(
          grow_stem({0, t * height, 0}, direction, length, 4, V3f(0, 0.03f, 0)));
      grow_side_twigs(stems.branches.back(), height, rng, stems.twigs);
    }
  }
  return stems;
}

/// Long twigs that hang from the ends of a tree's branches almost to the ground.
std::vector<Stem> hang_twigs(const TreeSkeleton& tree, float height, Pcg32& rng) {
  constexpr std::size_t kHanging = 900;
  std::vector<Stem> hanging;
  for (std::size_t i = 0; i < kHanging; ++i) {
    const std::uint32_t node = tree.twigs[i * tree.twigs.size() / kHanging];
    const V3f foot = tree.positions[node];
    const V3f lean = unit_vector(rng);
    const V3f outward = (V3f(foot.x, 0.2f * height, foot.z) / height + lean * 0.3f).normalized();
    const float room = std::max(0.05f * height, foot.y - 0.05f * height);
    const float length = std::min(room, 0.6f * height * rng.between(0.4f, 1.0f));
    hanging.push_back(grow_stem(foot, outward, length, 12, V3f(0, -0.55f, 0)));
  }
  return hanging;
}

}  // namespace

Scene make_palm_scene(const ProceduralParameters& parameters) {
  const float height = parameters.real("height");
  const std::uint32_t seed = parameters.whole("seed");
  Pcg32 rng(seed, kStemStream);
  const V2f lean = spiral_azimuth(0, rng.between(0, 6));
  const Stem trunk = grow_stem({0, 0, 0}, V3f(lean.x * 0.3f, 1, lean.y * 0.3f).normalized(),
                               0.8f * height, 16, V3f(0, 0.03f, 0));
  const std::vector<Stem> fronds = grow_fronds(trunk.points.back(), height, rng);
  Mesh mesh;
  std::vector<float> radii;
  for (std::size_t i = 0; i < trunk.points.size(); ++i)
    radii.push_back(height * (0.018f - 0.0004f * static_cast<float>(i)));
  append_tube(mesh, trunk.points, radii, 12, kBark);
  append_stem_tubes(mesh, fronds, 0.002f * height, 3, kBark);
  BladeHabit habit{blade_length(parameters, 0.06f * height, 6000)};
  habit.width = 0.08f;
  habit.forward = 0.8f;
  habit.droop = 0.35f;
  habit.two_ranked = true;
  append_blades(mesh, fronds, parameters.whole("leaves"), habit, seed, kLeaf);
  return scene_of_plant(parameters, std::move(mesh), "palm");
}

Scene make_conifer_scene(const ProceduralParameters& parameters) {
  const float height = parameters.real("height");
  const std::uint32_t seed = parameters.whole("seed");
  Pcg32 rng(seed, kStemStream);
  ConiferStems stems = grow_whorls(height, rng);
  Mesh mesh;
  append_stem_tubes(mesh, {grow_stem({0, 0, 0}, {0, 1, 0}, height, 12, {0, 0, 0})}, 0.016f * height,
                    12, kBark);
  append_stem_tubes(mesh, stems.branches, 0.003f * height, 5, kBark);
  append_stem_tubes(mesh, stems.twigs, 0.0006f * height, 3, kBark);
  BladeHabit habit{blade_length(parameters, 0.006f * height, 300000)};
  habit.forward = 0.9f;
  append_blades(mesh, stems.twigs, parameters.whole("leaves"), habit, seed, kLeaf);
  return scene_of_plant(parameters, std::move(mesh), "conifer");
}

Scene make_willow_scene(const ProceduralParameters& parameters) {
  const float height = parameters.real("height");
  const std::uint32_t seed = parameters.whole("seed");
  const TreeSkeleton tree = grow_skeleton(seed, height);
  Pcg32 rng(seed, kStemStream);
  const std::vector<Stem> hanging = hang_twigs(tree, height, rng);
  Mesh mesh;
  append_wood(mesh, tree, nullptr, kBark);
  append_stem_tubes(mesh, hanging, 0.0005f * height, 3, kBark);
  BladeHabit habit{blade_length(parameters, 0.012f * height, 80000)};
  habit.width = 0.16f;
  habit.forward = 1.2f;
  habit.droop = 0.8f;
  append_blades(mesh, hanging, parameters.whole("leaves"), habit, seed, kLeaf);
  return scene_of_plant(parameters, std::move(mesh), "willow");
}

Scene make_grass_scene(const ProceduralParameters& parameters) {
  const float length = parameters.real("length"), width = 0.2f * length;
  const std::uint32_t blades = parameters.whole("leaves"), seed = parameters.whole("seed");
  const float blade = blade_length(parameters, 0.005f * length, 400000);
  Mesh mesh;
  mesh.name = "grass";
  BladeRange range(mesh, blades, kLeaf);
  for (std::uint32_t i = 0; i < blades; ++i) {
    Pcg32 rng(seed, i);
    const V3f lean = unit_vector(rng);
    const V2f turn = unit_circle(rng);
    Blade grown;
    const float x = rng.between(-0.5f, 0.5f) * width, z = rng.between(-0.5f, 0.5f) * length;
    grown.base = V3f(x, 0, z);
    grown.axis = (V3f(0, 1.3f, 0) + lean * 0.8f).normalized();
    const V3f facing(turn.x, 0, turn.y);
    grown.normal = (facing - grown.axis * facing.dot(grown.axis)).normalized();
    grown.length = blade * rng.between(0.6f, 1.4f);
    grown.width = 0.05f;
    range.set(i, grown);
  }
  Scene scene;
  scene.materials = {blend_material("leaf", parameters.real("opacity")), opaque_material("ground")};
  place(scene, std::move(mesh));
  Mesh ground;
  ground.name = "ground";
  append_square(ground, 2 * length, 0, 1);
  place(scene, std::move(ground));
  scene.cameras.push_back(
      look_at({0, 0.016f * length, 0.53f * length}, {0, 0, -0.1f * length}, {0, 1, 0}, 0.5f));
  scene.cameras.back().name = "grazing";
  return scene;
}

}  // namespace dapple
