// scene:flower: smooth surfaces whose normals are those of their triangles, counts that follow the
// parameters, and a file that holds all of it but the lights.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "dapple/scene.hpp"
#include "scene/procedural/shown_scene.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kPetal = 0, kFloret = 1, kLeaf = 2;

std::size_t triangles_of(const std::string& query, std::uint32_t material) {
  const Mesh mesh = make_procedural("scene:flower?" + query).meshes.at(0);
  return static_cast<std::size_t>(
      std::count(mesh.materials.begin(), mesh.materials.end(), material));
}

TEST(Flower, NormalsAreUnitAndOnTheFrontSideOfTheirTriangles) {
  for (const char* seed : {"1", "2", "3"}) {
    const Scene scene = make_procedural(std::string("scene:flower?blooms=7&seed=") + seed);
    const Mesh& mesh = scene.meshes.at(0);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const V3f& normal : mesh.normals) ASSERT_NEAR(normal.length(), 1, 1e-5);
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      const std::uint32_t* const index = &mesh.indices[3 * t];
      const V3f a = mesh.positions[index[0]];
      const V3f face =
          (mesh.positions[index[1]] - a).cross(mesh.positions[index[2]] - a).normalized();
      for (int k = 0; k < 3; ++k)
        ASSERT_GT(mesh.normals[index[k]].dot(face), 0.0f)
            << "triangle " << t << " of material " << mesh.materials[t] << ", seed " << seed;
    }
  }
}

TEST(Flower, PetalsAreSmooth) {
  // Where a normal is far from the faces around it, a petal shows its triangles.
  const Mesh mesh = make_procedural("scene:flower").meshes.at(0);
  double sum = 0;
  std::size_t corners = 0;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    if (mesh.materials[t] != kPetal) continue;
    const std::uint32_t* const index = &mesh.indices[3 * t];
    const V3f a = mesh.positions[index[0]];
    const V3f face =
        (mesh.positions[index[1]] - a).cross(mesh.positions[index[2]] - a).normalized();
    for (int k = 0; k < 3; ++k, ++corners)
      sum += std::acos(std::min(1.0, double{mesh.normals[index[k]].dot(face)}));
  }
  EXPECT_LT(sum / static_cast<double>(corners), 0.1) << "radians, on average";
}

TEST(Flower, TheNumberOfTrianglesFollowsTheParameters) {
  // A petal has 5/2 detail rows of detail squares, a floret 30 triangles, and a dome 5 rings of 24
  // sides, of which the last one ends in a point.
  EXPECT_EQ(triangles_of("blooms=3&petals=13", kPetal), 3u * 13 * 2 * 20 * 8);
  EXPECT_EQ(triangles_of("blooms=3&petals=13&detail=4", kPetal), 3u * 13 * 2 * 10 * 4);
  EXPECT_EQ(triangles_of("blooms=2&florets=50", kFloret), 2u * (50 * 30 + 9 * 24));
  EXPECT_EQ(triangles_of("leaves=9", kLeaf) - triangles_of("leaves=0", kLeaf), 9u * 2 * 20 * 6);
  const Scene scene = make_procedural("scene:flower?clumps=4");
  EXPECT_EQ(scene.instances.size(), 5u) << "and the ground";
  const std::size_t triangles = scene.meshes.at(0).primitive_count();
  EXPECT_GT(triangles, 20000u);
  EXPECT_LT(triangles, 100000u);
}

TEST(Flower, StandsOnTheGroundAndHasAboutTheHeightOfItsParameter) {
  for (const float height : {0.05f, 0.35f, 2.0f}) {
    for (const char* blooms : {"1", "5", "60"}) {
      const Scene scene = make_procedural("scene:flower?clumps=1&height=" + std::to_string(height) +
                                          "&blooms=" + blooms);
      Box3f box;
      for (const V3f& p : scene.meshes.at(0).positions) box.extendBy(p);
      EXPECT_NEAR(box.min.y / height, 0, 0.02) << blooms;
      EXPECT_NEAR(box.max.y / height, 1, 0.25) << blooms;
      Box3f ground;
      for (const V3f& p : scene.meshes.at(1).positions) ground.extendBy(p);
      EXPECT_EQ(ground.min.y, 0.0f);
      EXPECT_EQ(ground.max.y, 0.0f);
      EXPECT_GT(ground.max.x, 10 * box.max.x);
    }
  }
}

TEST(Flower, HasDaylightAndACameraThatSeesEveryHead) {
  const Scene scene = make_procedural("scene:flower");
  const Mesh& mesh = scene.meshes.at(0);
  std::vector<V3f> petals;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    if (mesh.materials[i / 3] == kPetal) petals.push_back(mesh.positions[mesh.indices[i]]);
  scene_test::expect_daylight_and_a_view_of(scene, petals);
}

TEST(Flower, AFileHoldsItsColoursNormalsAndLens) {
  const Scene made = make_procedural("scene:flower?blooms=1&clumps=2");
  const auto path = std::filesystem::temp_directory_path() /
                    ("dapple_flower_" + std::to_string(getpid()) + ".glb");
  write_glb(made, path.string());
  SceneOptions options;
  options.colors = true;
  const Scene read = load_gltf(path.string(), options);
  std::filesystem::remove(path);
  ASSERT_EQ(read.meshes.size(), 2u);
  EXPECT_EQ(read.instances.size(), made.instances.size());
  const auto color_sum = [](const Scene& scene) {
    V3d sum(0, 0, 0);
    const Mesh& mesh = scene.meshes[0];
    for (const std::uint32_t v : mesh.indices) sum += V3d(mesh.colors.at(v) + mesh.normals.at(v));
    return sum;
  };
  EXPECT_NEAR((color_sum(read) - color_sum(made)).length(), 0, 1e-6 * color_sum(made).length());
  ASSERT_EQ(read.cameras.size(), 1u);
  EXPECT_TRUE(read.cameras[0].to_world.equalWithAbsError(made.cameras[0].to_world, 1e-6f));
  EXPECT_EQ(read.cameras[0].lens_radius, made.cameras[0].lens_radius);
  EXPECT_EQ(read.cameras[0].focus_distance, made.cameras[0].focus_distance);
  EXPECT_TRUE(read.warnings.empty());
}

}  // namespace
}  // namespace dapple
