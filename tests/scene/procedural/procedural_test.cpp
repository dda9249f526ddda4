// Procedural scenes: a seed always gives the same bits, counts and sizes are those of the
// parameters, and the messages about wrong parameters name the allowed values.
#include "scene/procedural/procedural.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "dapple/error.hpp"
#include "dapple/moving_scene.hpp"
#include "dapple/scene.hpp"
#include "scene/corner_normals.hpp"
#include "scene/procedural/shown_scene.hpp"
#include "support/fingerprint.hpp"
namespace dapple {
namespace {

// A hash of everything in a scene that affects the picture.
std::uint64_t hash_of(const Scene& scene) {
  Fingerprint hash;
  for (const Mesh& mesh : scene.meshes) {
    hash.add(mesh.positions);
    hash.add(mesh.indices);
    hash.add(mesh.materials);
    hash.add(mesh.radii);
    hash.add(mesh.normals);
    hash.add(mesh.colors);
  }
  for (const Instance& instance : scene.instances) {
    hash.add_bytes(&instance.mesh, sizeof instance.mesh);
    hash.add_bytes(instance.to_world.getValue(), 16 * sizeof(float));
  }
  return hash.value();
}

int material_named(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (scene.materials[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

std::size_t triangles_of(const Mesh& mesh, int material) {
  return static_cast<std::size_t>(
      std::count(mesh.materials.begin(), mesh.materials.end(), material));
}

double area_of(const Mesh& mesh, std::size_t triangle) {
  const std::uint32_t* const index = &mesh.indices[3 * triangle];
  const Imath::V3d a(mesh.positions[index[0]]), b(mesh.positions[index[1]]),
      c(mesh.positions[index[2]]);
  return (b - a).cross(c - a).length() / 2;
}

double area_of(const Mesh& mesh, int material) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    if (mesh.materials[t] == static_cast<std::uint32_t>(material)) area += area_of(mesh, t);
  }
  return area;
}

std::string complaint(const std::string& name) {
  try {
    make_procedural(name);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "no error";
}

TEST(Procedural, TheSameSeedGivesTheSameBitsAndAnotherSeedDoesNot) {
  for (const char* scene :
       {"tree?leaves=3000", "cloud?leaves=3000", "forest?leaves=100", "palm?leaves=100",
        "conifer?leaves=100", "willow?leaves=100", "grass?leaves=100", "flower?blooms=2"}) {
    const std::string name = std::string("scene:") + scene;
    const std::uint64_t once = hash_of(make_procedural(name + "&seed=5"));
    EXPECT_EQ(once, hash_of(make_procedural(name + "&seed=5"))) << scene;
    EXPECT_NE(once, hash_of(make_procedural(name + "&seed=6"))) << scene;
  }
}

TEST(Procedural, TheNumberOfThreadsDoesNotChangeABit) {
  const std::string name = "scene:tree?leaves=60000";
  const std::uint64_t many = hash_of(make_procedural(name));
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(many, hash_of(make_procedural(name)));
}

// The hashes were recorded once. Pictures are compared across machines and compilers, so their
// scenes must have the same bits there.
TEST(Procedural, ASceneHasTheSameBitsOnEveryMachine) {
  EXPECT_EQ(hash_of(make_procedural("scene:tree?leaves=1000")), 0xc99b236055b03942ULL);
  EXPECT_EQ(hash_of(make_procedural("scene:cloud?leaves=1000")), 0xd28a0aff605cce05ULL);
  EXPECT_EQ(hash_of(make_procedural("scene:forest?leaves=50&trees=9")), 0xe9afb7fcfe75c3f1ULL);
}

TEST(Procedural, ATreeHasExactlyTheNumberOfLeavesOfItsParameter) {
  for (const std::size_t leaves : {1u, 2u, 77u, 1234u, 50001u}) {
    const Scene scene = make_procedural("scene:tree?leaves=" + std::to_string(leaves));
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(triangles_of(mesh, material_named(scene, "leaf")), 2 * leaves);
    EXPECT_EQ(mesh.primitive_count(),
              2 * leaves + triangles_of(mesh, material_named(scene, "bark")));
  }
}

TEST(Procedural, ATreeWithoutWoodIsOnlyItsLeaves) {
  const Scene scene = make_procedural("scene:tree?leaves=500&wood=0");
  EXPECT_EQ(material_named(scene, "bark"), -1);
  EXPECT_EQ(scene.meshes.at(0).primitive_count(), 1000u);
}

// The flux of the position through a closed surface is three times its volume, if front sides are
// outside. Tubes are open at their beginning, which is inside of another one or at the origin.
TEST(Procedural, TheFrontSidesOfBarkAreOutside) {
  const Scene scene = make_procedural("scene:tree?leaves=1000");
  const Mesh& mesh = scene.meshes.at(0);
  const int bark = material_named(scene, "bark");
  double flux = 0;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    if (static_cast<int>(mesh.materials[t]) != bark) continue;
    const V3f &a = mesh.positions[mesh.indices[3 * t]],
              &b = mesh.positions[mesh.indices[3 * t + 1]],
              &c = mesh.positions[mesh.indices[3 * t + 2]];
    flux += 0.5 * double{(b - a).cross(c - a).dot(a)};
  }
  EXPECT_GT(flux, 0);
}

TEST(Procedural, ThickBranchesAreRoundAndLeavesAreFlat) {
  const Scene scene = make_procedural("scene:tree?leaves=1000");
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  const int bark = material_named(scene, "bark");
  std::size_t smooth = 0;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const auto normals = corner_normals(mesh, t);
    smooth += normals.has_value();
    ASSERT_FALSE(normals && static_cast<int>(mesh.materials[t]) != bark);
  }
  EXPECT_GT(smooth, triangles_of(mesh, bark) / 20);
  for (const V3f& normal : mesh.normals) {
    const float length = normal.length();
    ASSERT_TRUE(length == 0 || std::abs(length - 1) < 1e-5f) << length;
  }
}

TEST(Procedural, ATreeStandsOnTheOriginAndHasAboutTheHeightOfItsParameter) {
  for (const float height : {1.0f, 8.0f, 30.0f}) {
    const Scene scene = make_procedural("scene:tree?leaves=20000&height=" + std::to_string(height));
    const Box3f bounds = scene_bounds(scene);
    EXPECT_EQ(bounds.min.y, 0.0f);
    // The highest leaves end near the top of the crown, for every seed.
    EXPECT_NEAR(bounds.max.y / height, 1, 0.1);
    // The crown's radius is 0.33 of the height, and leaves reach 0.05 beyond their twigs.
    EXPECT_LT(std::max(bounds.size().x, bounds.size().z) / height, 0.8f);
    EXPECT_GT(std::min(bounds.size().x, bounds.size().z) / height, 0.4f);
  }
}

// No leaf is near the ground, and the crown is wider in the middle than at the top.
TEST(Procedural, ATreeHasABareTrunkUnderAnEggShapedCrown) {
  const Scene scene = make_procedural("scene:tree?leaves=20000&wood=0");
  double radius_sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (const V3f& p : scene.meshes.at(0).positions) {
    EXPECT_GT(p.y, 0.1f * 8);
    const int part = p.y > 0.85f * 8 ? 1 : p.y > 0.35f * 8 && p.y < 0.65f * 8 ? 0 : -1;
    if (part < 0) continue;
    radius_sum[part] += std::hypot(p.x, p.z);
    ++count[part];
  }
  EXPECT_GT(radius_sum[0] / count[0], 1.3 * radius_sum[1] / count[1]);
}

TEST(Procedural, LeafAreaStaysTheSameAsLeavesGrow) {
  for (const std::string plant : {"tree", "cloud"}) {
    const Scene few = make_procedural("scene:" + plant + "?leaves=10000");
    const Scene many = make_procedural("scene:" + plant + "?leaves=160000");
    const double ratio = area_of(many.meshes.at(0), material_named(many, "leaf")) /
                         area_of(few.meshes.at(0), material_named(few, "leaf"));
    // The standard deviation of squared lengths is 0.3 of their mean, so the mean of 10,000 leaves
    // has an error of 0.003.
    EXPECT_NEAR(ratio, 1, 0.02) << plant;
  }
}

TEST(Procedural, LeafSizeSetsTheLengthOfLeaves) {
  const Scene scene = make_procedural("scene:cloud?leaves=50&leaf_size=0.25");
  const Mesh& mesh = scene.meshes.at(0);
  for (std::size_t leaf = 0; leaf < 50; ++leaf) {
    EXPECT_NEAR((mesh.positions[4 * leaf + 2] - mesh.positions[4 * leaf]).length(), 0.25, 1e-5);
  }
}

TEST(Procedural, ALeafIsTwoTrianglesThatShareAnEdge) {
  const Mesh mesh = make_procedural("scene:cloud?leaves=20").meshes.at(0);
  for (std::size_t leaf = 0; leaf < 20; ++leaf) {
    const auto first = mesh.indices.begin() + static_cast<std::ptrdiff_t>(6 * leaf);
    const int shared = static_cast<int>(std::count_if(
        first, first + 3, [&](auto v) { return std::count(first + 3, first + 6, v) > 0; }));
    EXPECT_EQ(shared, 2);
  }
}

TEST(Procedural, ACloudIsABallOfUniformDensity) {
  const Mesh mesh = make_procedural("scene:cloud?leaves=40000").meshes.at(0);
  int inner = 0;
  for (std::size_t leaf = 0; leaf < 40000; ++leaf) {
    const V3f centre = (mesh.positions[4 * leaf] + mesh.positions[4 * leaf + 2]) * 0.5f;
    const float r = (centre - V3f(0, 2.5f, 0)).length();
    EXPECT_LE(r, 2.0001f);
    inner += r < 1;
  }
  // An eighth of the volume should hold 5000 leaves, with a standard deviation of 66.
  EXPECT_NEAR(inner, 5000, 4 * 66);
}

TEST(Procedural, AForestPlacesEachSpeciesAtLeastOnce) {
  const Scene scene = make_procedural("scene:forest?trees=5&species=3&leaves=10");
  ASSERT_EQ(scene.meshes.size(), 4u);     // three trees and the ground
  ASSERT_EQ(scene.instances.size(), 6u);  // five trees and the ground
  for (std::uint32_t mesh = 0; mesh < 4; ++mesh) {
    EXPECT_TRUE(std::any_of(scene.instances.begin(), scene.instances.end(),
                            [&](const Instance& i) { return i.mesh == mesh; }));
  }
  EXPECT_NE(scene.meshes[0].positions, scene.meshes[1].positions);
  EXPECT_EQ(make_procedural("scene:forest?trees=2&leaves=10").meshes.size(), 3u);
}

TEST(Procedural, ForestTreesAreTurnedAboutYAndScaledWithinBounds) {
  const Scene scene = make_procedural("scene:forest?trees=100&leaves=10");
  for (std::size_t i = 0; i < 100; ++i) {
    const M44f& m = scene.instances[i].to_world;
    const float scale = m[1][1];
    EXPECT_GE(scale, 0.7f);
    EXPECT_LT(scale, 1.3f);
    EXPECT_NEAR(V3f(m[0][0], m[0][1], m[0][2]).length(), scale, 1e-5);
    EXPECT_NEAR(m.determinant(), scale * scale * scale, 1e-4);  // a rotation, not a mirror
    EXPECT_EQ(m[3][1], 0.0f);
  }
}

TEST(Procedural, SheetsOfAStackHaveTheGapsOfItsParameters) {
  const Scene scene = make_procedural("scene:stack?layers=3&gap=0.5&opacity=0.4");
  EXPECT_EQ(scene.materials.at(0).name, "sheet");
  EXPECT_EQ(scene.materials.at(0).alpha_mode, AlphaMode::blend);
  EXPECT_FLOAT_EQ(scene.materials.at(0).alpha, 0.4f);
  EXPECT_EQ(scene.materials.at(1).alpha_mode, AlphaMode::opaque);
  const Mesh& sheets = scene.meshes.at(0);
  ASSERT_EQ(sheets.primitive_count(), 6u);
  for (std::size_t i = 0; i < sheets.positions.size(); ++i) {
    EXPECT_FLOAT_EQ(sheets.positions[i].y, 0.5f * static_cast<float>(i / 4 + 1));
    EXPECT_FLOAT_EQ(std::abs(sheets.positions[i].x), 1);
  }
}

TEST(Procedural, ADisksAreaIsThatOfItsPolygon) {
  const Mesh disk = make_procedural("scene:disk?segments=6&radius=2&height=3").meshes.at(0);
  EXPECT_NEAR(area_of(disk, 0), 6 * std::sqrt(3.0), 1e-5);  // a hexagon: 3/2 sqrt(3) r^2
  for (const V3f& p : disk.positions) EXPECT_EQ(p.y, 3.0f);
}

TEST(Procedural, ACubeIsClosedAndFacesOutward) {
  const Mesh cube = make_procedural("scene:cube?divisions=4").meshes.at(0);
  double area = 0, volume = 0;
  for (std::size_t t = 0; t < cube.primitive_count(); ++t) {
    const std::uint32_t* const index = &cube.indices[3 * t];
    const Imath::V3d a(cube.positions[index[0]]), b(cube.positions[index[1]]),
        c(cube.positions[index[2]]);
    area += area_of(cube, t);
    volume += a.dot(b.cross(c)) / 6;  // signed: 1 only when closed and outward
  }
  EXPECT_NEAR(area, 6, 1e-6);
  EXPECT_NEAR(volume, 1, 1e-6);
}

TEST(Procedural, EveryTriangleOfEverySceneIsFiniteAndHasAnArea) {
  for (const ProceduralHelp& help : procedural_help()) {
    Scene scene = make_procedural("scene:" + help.name);
    ASSERT_FALSE(scene.instances.empty()) << help.name;
    for (const Mesh& mesh : scene.meshes) {
      if (mesh.has_strands()) continue;  // procedural_hair_test.cpp
      ASSERT_EQ(mesh.indices.size(), 3 * mesh.primitive_count());
      for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
        ASSERT_LT(mesh.materials[t], scene.materials.size());
        ASSERT_GT(area_of(mesh, t), 1e-12) << help.name;  // false for a NaN too
      }
    }
  }
}

TEST(Procedural, TheDemoHasASunASkyAndACameraThatSeesTheTree) {
  const Scene scene = make_procedural("scene:demo");
  scene_test::expect_daylight_and_a_view_of(scene, scene.meshes.at(0).positions);
}

TEST(Procedural, DefaultsAreThoseThatTheHelpShows) {
  for (const ProceduralHelp& help : procedural_help()) {
    std::string query = "?";
    for (const ProceduralParameter& parameter : help.parameters) {
      EXPECT_FALSE(parameter.help.empty());
      std::string value = std::to_string(parameter.default_value);  // "0.850000"
      query += (query.size() > 1 ? "&" : "") + parameter.name + "=" + value;
    }
    if (help.name == "forest") continue;  // the same code as scene:tree, but slower
    EXPECT_EQ(hash_of(make_procedural("scene:" + help.name + query)),
              hash_of(make_procedural("scene:" + help.name)))
        << query;
  }
}

TEST(Procedural, AnUnknownSceneOrKeyIsRefusedWithTheKnownOnes) {
  EXPECT_EQ(complaint("scene:oak"),
            "scene:oak: there is no such scene; there are: demo, tree, cloud, forest, palm, "
            "conifer, willow, grass, flower, hair, stack, disk, cube, greys, sieve");
  EXPECT_EQ(complaint("scene:cube?side=2"),
            "scene:cube: there is no parameter \"side\"; there are: divisions");
  EXPECT_EQ(complaint("scene:demo?leaves=3"),
            "scene:demo: there is no parameter \"leaves\"; there are: none");
}

TEST(Procedural, AValueThatIsNoNumberOrOutOfRangeIsRefused) {
  EXPECT_EQ(complaint("scene:tree?leaves=0"), "scene:tree: leaves=0 is outside [1, 10000000]");
  EXPECT_EQ(complaint("scene:tree?leaves=1.5"), "scene:tree: leaves=1.5 is not a whole number");
  EXPECT_EQ(complaint("scene:tree?opacity=2"), "scene:tree: opacity=2 is outside [0, 1]");
  EXPECT_EQ(complaint("scene:tree?opacity=nan"), "scene:tree: opacity=nan is outside [0, 1]");
  EXPECT_EQ(complaint("scene:tree?opacity=half"), "scene:tree: opacity=half is not a number");
  EXPECT_EQ(complaint("scene:tree?opacity=0.5x"), "scene:tree: opacity=0.5x is not a number");
  EXPECT_EQ(complaint("scene:tree?opacity="), "scene:tree: opacity= is not a number");
  EXPECT_EQ(complaint("scene:tree?opacity"),
            "scene:tree: \"opacity\" is not of the form key=value");
  EXPECT_EQ(complaint("scene:tree?seed=1&seed=2"), "scene:tree: seed is given twice");
  EXPECT_EQ(complaint("scene:cloud?leaf_size=1e-9"),
            "scene:cloud: leaf_size must be 0 (automatic) or at least 0.001 m");
  EXPECT_EQ(complaint("scene:palm?leaf_size=0.0005"),
            "scene:palm: leaf_size must be 0 (automatic) or at least 0.001 m");
}

TEST(Procedural, AMovingSceneIsRefusedAtOnce) {
  EXPECT_THROW(MovingScene("scene:nope"), Error);
  EXPECT_THROW(MovingScene("scene:tree?leaves=abc"), Error);
}

TEST(Procedural, OneLeafIsNotMuchLargerThanItsPlant) {
  for (const char* plant : {"palm", "conifer", "willow", "tree"}) {
    const std::string scene = "scene:" + std::string(plant) + "?height=2&leaves=";
    const V3f one = scene_bounds(load_scene(scene + "1")).size();
    const V3f many = scene_bounds(load_scene(scene + "10000")).size();
    EXPECT_LT(one.length(), 2 * many.length()) << plant;
  }
}

TEST(LoadScene, ASceneNameIsMadeAndRemembered) {
  const Scene scene = load_scene("scene:disk?segments=8");
  EXPECT_EQ(scene.source, "scene:disk?segments=8");
  EXPECT_EQ(scene.meshes.at(0).primitive_count(), 8u);
}

}  // namespace
}  // namespace dapple
