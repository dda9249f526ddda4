// Values at the borders of meshes side by side: tiles of a floor have no seam, an edge between a
// floor and a wall stays one.
#include "bake/mesh_borders.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "support/not_empty.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// A square of 1 m in the plane y = 0, from (0, 0, 0) to (1, 0, 1).
Mesh tile() {
  Mesh mesh;
  append_grid(mesh, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 4, 0);
  return mesh;
}

/// Two tiles side by side, a wall behind one of them, and a sun. The second tile is turned, or
/// mirrored.
Scene two_tiles(bool mirrored) {
  Scene scene;
  scene.materials.resize(1);
  place(scene, tile());
  place(scene, tile());
  Mesh wall;
  append_grid(wall, {0.2f, 0, 0}, {0.8f, 0, 0}, {0, 1, 0}, 2, 0);
  place(scene, wall);
  M44f& second = scene.instances[1].to_world;
  if (mirrored)
    second = M44f(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1);
  else  // by 90 degrees about Y
    second = M44f(0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 2, 0, 0, 1);
  Light sun;
  sun.kind = LightKind::sun;
  sun.name = "sun";
  sun.direction = V3f(0.3f, -1, 0.2f).normalized();
  sun.angular_radius = 0.01f;
  sun.radiance = V3f(1 / (3.14159265f * 1e-4f));  // irradiance 1
  scene.lights = {sun};
  return scene;
}

BakeOptions options() {
  BakeOptions options;
  options.bent = options.light = true;
  options.sides = BakeSides::front;
  options.rays = 256;
  options.target_error = 0;
  return options;
}

struct BorderValue {
  float ao, light;
  V3f bent;  ///< in the world
};

/// Of the vertices of an instance's mesh at x = 1, by z in quarters.
std::map<int, BorderValue> border(const Scene& scene, const BakeResult& baked, std::size_t i) {
  std::map<int, BorderValue> values;
  const Instance& instance = scene.instances[i];
  const Mesh& mesh = scene.meshes[instance.mesh];
  const BakedMesh& of_mesh = baked.meshes[instance.mesh];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const V3f at = mesh.positions[v] * instance.to_world;
    if (std::fabs(at.x - 1) > 1e-5f || at.y != 0) continue;
    V3f bent;
    instance.to_world.multDirMatrix(of_mesh.bent[v], bent);
    values[static_cast<int>(std::lround(4 * at.z))] = {of_mesh.ao[v], of_mesh.light[0][v].x, bent};
  }
  return values;
}

TEST(MeshBorders, TilesSideBySideHaveOneValue) {
  for (const bool mirrored : {false, true}) {
    const Scene scene = two_tiles(mirrored);
    const BakeResult baked = bake(scene, options());
    const auto first = border(scene, baked, 0), second = border(scene, baked, 1);
    ASSERT_EQ(first.size(), 5u);
    ASSERT_EQ(second.size(), 5u);
    for (const auto& [z, value] : first) {
      SCOPED_TRACE(z);
      EXPECT_EQ(value.ao, second.at(z).ao);
      EXPECT_EQ(value.light, second.at(z).light);
      EXPECT_LT((value.bent - second.at(z).bent).length(), 1e-5f);
    }
    EXPECT_LT(first.at(0).ao, 0.8f) << "beside the wall";
    EXPECT_GT(first.at(4).ao, 0.9f);
  }
}

TEST(MeshBorders, AnEdgeBetweenAFloorAndAWallStaysOne) {
  Scene scene = two_tiles(false);
  scene.instances.erase(scene.instances.begin() + 1);
  scene.lights[0].direction = V3f(0, -1, 0.001f).normalized();  // along the wall
  const BakeResult baked = bake(scene, options());
  for (const V3f& floor : not_empty(baked.meshes[0].light.at(0))) EXPECT_GT(floor.x, 0.9f);
  for (const V3f& wall : not_empty(baked.meshes[2].light.at(0))) EXPECT_LT(wall.x, 0.1f);
}

TEST(MeshBorders, MeshesThatArePlacedSeveralTimesKeepTheirValues) {
  Scene scene = two_tiles(false);
  Instance again = scene.instances[1];
  again.to_world[3][0] += 50;
  scene.instances.push_back(again);
  const BakeResult baked = bake(scene, options());
  const auto first = border(scene, baked, 0), second = border(scene, baked, 1);
  EXPECT_NE(first.at(0).ao, second.at(0).ao);
}

}  // namespace
}  // namespace dapple
