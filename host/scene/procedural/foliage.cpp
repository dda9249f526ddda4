// Makes procedural foliage: a tree, a cloud of leaves, a forest of instances, and the demo.
// In: checked parameters; out: a scene.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "scene/procedural/mesh_shapes.hpp"
#include "scene/procedural/pcg32.hpp"
#include "scene/procedural/scenes.hpp"
#include "scene/procedural/tree.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kLeafMaterial = 0;
constexpr std::uint32_t kBarkMaterial = 1;
constexpr std::uint32_t kGroundMaterial = 2;
constexpr float kDemoOpacity = 0.85f;  // as the leaves in Lacewell et al. 2008

void add_tree_materials(Scene& scene, float opacity, bool wood) {
  scene.materials.push_back(blend_material("leaf", opacity));
  if (wood) scene.materials.push_back(opaque_material("bark"));
}

void add_ground_square(Scene& scene, float side) {
  scene.materials.push_back(opaque_material("ground"));
  Mesh ground;
  ground.name = "ground";
  append_square(ground, side, 0, kGroundMaterial);
  place(scene, std::move(ground));
}

float cloud_leaf_length(const ProceduralParameters& parameters) {
  if (const float given = given_leaf_length(parameters); given > 0) return given;
  // leaves * length^2 is constant, so that any number of leaves has the leaf area of 20,000 leaves
  // of 5 cm, and thus the same optical depth through the middle.
  const float length = 0.05f * std::sqrt(20000.0f / static_cast<float>(parameters.whole("leaves")));
  return std::min(length, 0.5f);
}

Blade float_leaf(Pcg32& rng, float length) {
  const V3f place_in_ball = point_in_ball(rng);
  Blade blade;
  blade.axis = unit_vector(rng);
  const V3f u = perpendicular(blade.axis);
  const V2f turn = unit_circle(rng);
  blade.normal = u * turn.x + blade.axis.cross(u) * turn.y;
  blade.length = length;
  blade.base = V3f(0, 2.5f, 0) + place_in_ball * 2.0f - blade.axis * (length / 2);
  return blade;
}

M44f forest_placement(Pcg32& rng, std::uint32_t tree, std::uint32_t row_length, float spacing) {
  const auto cell = [&](std::uint32_t index) {
    return (static_cast<float>(index) - 0.5f * static_cast<float>(row_length - 1)) * spacing;
  };
  const float x = cell(tree % row_length) + rng.between(-0.35f, 0.35f) * spacing;
  const float z = cell(tree / row_length) + rng.between(-0.35f, 0.35f) * spacing;
  const float scale = rng.between(0.7f, 1.3f);
  const V2f turn = unit_circle(rng) * scale;
  return {turn.x, 0, -turn.y, 0, 0, scale, 0, 0, turn.y, 0, turn.x, 0, x, 0, z, 1};
}

}  // namespace

Scene make_tree_scene(const ProceduralParameters& parameters) {
  TreeShape shape;
  shape.leaves = parameters.whole("leaves");
  shape.seed = parameters.whole("seed");
  shape.height_m = parameters.real("height");
  shape.leaf_length_m = given_leaf_length(parameters);
  shape.wood = parameters.whole("wood") == 1;
  if (parameters.time()) shape.wind = {double{parameters.real("wind")}, *parameters.time()};
  Scene scene;
  add_tree_materials(scene, parameters.real("opacity"), shape.wood);
  place(scene, make_tree(shape, {kLeafMaterial, kBarkMaterial}));
  return scene;
}

Scene make_cloud_scene(const ProceduralParameters& parameters) {
  const std::uint32_t leaves = parameters.whole("leaves");
  const std::uint32_t seed = parameters.whole("seed");
  const float length = cloud_leaf_length(parameters);
  Mesh mesh;
  mesh.name = "cloud";
  BladeRange blades(mesh, leaves, kLeafMaterial);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, leaves, 4096), [&](const auto& range) {
    for (std::uint32_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      Pcg32 rng(seed, leaf);
      blades.set(leaf, float_leaf(rng, length));
    }
  });
  Scene scene;
  scene.materials.push_back(blend_material("leaf", parameters.real("opacity")));
  place(scene, std::move(mesh));
  return scene;
}

Scene make_forest_scene(const ProceduralParameters& parameters) {
  const std::uint32_t trees = parameters.whole("trees");
  const std::uint32_t species = std::min(parameters.whole("species"), trees);
  const std::uint32_t seed = parameters.whole("seed");
  const float spacing = parameters.real("spacing");
  Scene scene;
  add_tree_materials(scene, parameters.real("opacity"), true);
  for (std::uint32_t i = 0; i < species; ++i) {
    TreeShape shape;
    shape.leaves = parameters.whole("leaves");
    shape.seed = seed + i;
    scene.meshes.push_back(make_tree(shape, {kLeafMaterial, kBarkMaterial}));
    scene.meshes.back().name = "tree_" + std::to_string(i + 1);
  }
  const auto row_length =
      static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(trees))));
  for (std::uint32_t tree = 0; tree < trees; ++tree) {
    Pcg32 rng(seed, tree);
    Instance instance;
    instance.to_world = forest_placement(rng, tree, row_length, spacing);
    instance.mesh = tree < species ? tree : rng.below(species);  // uses each species at least once
    scene.instances.push_back(instance);
  }
  add_ground_square(scene, (static_cast<float>(row_length) + 3) * spacing);
  return scene;
}

Scene make_demo_scene(const ProceduralParameters&) {
  TreeShape shape;
  shape.leaves = 45000;
  Scene scene;
  add_tree_materials(scene, kDemoOpacity, true);
  place(scene, make_tree(shape, {kLeafMaterial, kBarkMaterial}));
  scene.cameras.push_back(look_at({1.5f, 2.6f, 14}, {0.6f, 3.85f, 0}, {0, 1, 0}, 0.62f));
  scene.cameras.back().name = "demo";
  scene.lights = daylight(scene.cameras.back());
  add_ground_square(scene, 1200);
  return scene;
}

}  // namespace dapple
