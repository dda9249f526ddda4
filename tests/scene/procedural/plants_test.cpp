// Plants of other habits: what makes each of them another test of nodes than a broad-leaved tree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "dapple/scene.hpp"
#include "scene/procedural/procedural.hpp"

namespace dapple {
namespace {

/// The corners of a blade's midrib, from its base to its tip. The last triangles of the mesh are
/// blades of two triangles each.
struct Midrib {
  V3f base, tip;
};

std::vector<Midrib> midribs(const Mesh& mesh, std::size_t blades) {
  std::vector<Midrib> all;
  for (std::size_t b = 0; b < blades; ++b) {
    const std::size_t triangle = mesh.primitive_count() - 2 * blades + 2 * b;
    all.push_back({mesh.positions[mesh.indices[3 * triangle]],
                   mesh.positions[mesh.indices[3 * triangle + 2]]});
  }
  return all;
}

std::size_t leaf_triangles(const Mesh& mesh) {
  return static_cast<std::size_t>(std::count(mesh.materials.begin(), mesh.materials.end(), 0u));
}

TEST(Plants, HaveExactlyTheBladesOfTheirParameter) {
  for (const std::string plant : {"palm", "conifer", "willow", "grass"}) {
    for (const std::size_t leaves : {1u, 77u, 5000u}) {
      const Scene scene = make_procedural("scene:" + plant + "?leaves=" + std::to_string(leaves));
      EXPECT_EQ(leaf_triangles(scene.meshes.at(0)), 2 * leaves) << plant;
    }
  }
}

TEST(Plants, StandOnTheGroundAndHaveAboutTheHeightOfTheirParameter) {
  for (const std::string plant : {"palm", "conifer", "willow"}) {
    for (const float height : {2.0f, 20.0f}) {
      const Scene scene =
          make_procedural("scene:" + plant + "?leaves=3000&height=" + std::to_string(height));
      Box3f box;
      for (const V3f& p : scene.meshes.at(0).positions) box.extendBy(p);
      EXPECT_NEAR(box.min.y / height, 0, 0.05) << plant;
      EXPECT_NEAR(box.max.y / height, 1, 0.15) << plant;
    }
  }
}

TEST(Plants, TheTwigsOfAWillowHang) {
  const Scene scene = make_procedural("scene:willow?leaves=5000");
  int falling = 0, low = 0;
  for (const Midrib& rib : midribs(scene.meshes.at(0), 5000)) {
    falling += rib.tip.y < rib.base.y ? 1 : 0;
    low += rib.base.y < 0.4f * 10 ? 1 : 0;
  }
  EXPECT_GT(falling, 4500);
  EXPECT_GT(low, 1000) << "of 5000; the crown of scene:tree has few leaves so low";
}

TEST(Plants, NeedlesStandAroundTwigsAndLeafletsInAPlane) {
  const Mesh conifer = make_procedural("scene:conifer?leaves=4000").meshes.at(0);
  int up = 0;
  for (const Midrib& rib : midribs(conifer, 4000)) up += rib.tip.y > rib.base.y ? 1 : 0;
  EXPECT_NEAR(up, 2000, 400);
  // The leaflets of a frond hang a little, whatever side they are on.
  const Mesh palm = make_procedural("scene:palm?leaves=4000").meshes.at(0);
  int hanging = 0;
  for (const Midrib& rib : midribs(palm, 4000)) hanging += rib.tip.y < rib.base.y ? 1 : 0;
  EXPECT_GT(hanging, 2600);
}

TEST(Plants, GrassStandsOnItsFieldAndTheCameraSeesItAtAGrazingAngle) {
  const Scene scene = make_procedural("scene:grass?leaves=3000&length=50");
  for (const Midrib& rib : midribs(scene.meshes.at(0), 3000)) {
    EXPECT_EQ(rib.base.y, 0.0f);
    EXPECT_LE(std::fabs(rib.base.x), 5.0f);
    EXPECT_LE(std::fabs(rib.base.z), 25.0f);
    EXPECT_GT(rib.tip.y, 0.0f);
  }
  ASSERT_EQ(scene.cameras.size(), 1u);
  const V3f view = -V3f(scene.cameras[0].to_world[2][0], scene.cameras[0].to_world[2][1],
                        scene.cameras[0].to_world[2][2]);
  EXPECT_LT(view.y, 0.0f);
  EXPECT_GT(view.y, -0.1f);
}

TEST(Plants, ASieveIsAsOpenAsItsParameterSays) {
  for (const char* open : {"0.25", "0.8"}) {
    const Scene scene = make_procedural(std::string("scene:sieve?holes=20&open=") + open);
    const Mesh& plate = scene.meshes.at(0);
    double area = 0;
    for (std::size_t t = 0; t < plate.primitive_count(); ++t) {
      const std::uint32_t* const index = &plate.indices[3 * t];
      const V3f a = plate.positions[index[0]];
      const V3f normal = (plate.positions[index[1]] - a).cross(plate.positions[index[2]] - a);
      EXPECT_GT(normal.y, 0.0f) << "its front is above";
      area += 0.5 * double{normal.length()};
    }
    EXPECT_NEAR(area, 4 * (1 - std::stod(open)), 1e-4);
  }
}

}  // namespace
}  // namespace dapple
