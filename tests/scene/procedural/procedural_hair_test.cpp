// The procedural scene scene:hair: a closed head, and strands that start on its scalp and stay
// outside of it. A seed always gives the same bits.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"

namespace dapple {
namespace {

const V3f kCentre(0, 0.12f, 0), kRadii(0.075f, 0.115f, 0.095f);

float head_distance(V3f p) { return ((p - kCentre) / kRadii).length(); }

TEST(ProceduralHair, HasTheStrandsSegmentsRadiiAndOpacityOfItsParameters) {
  const Scene scene = make_procedural("scene:hair?strands=70&segments=5&radius=0.001&opacity=0.4");
  const Mesh& hair = scene.meshes.at(0);
  ASSERT_TRUE(hair.has_strands());
  EXPECT_EQ(hair.primitive_count(), 350u);
  EXPECT_EQ(hair.positions.size(), 420u);
  EXPECT_EQ(hair.radii.size(), 420u);
  for (const float radius : hair.radii) EXPECT_TRUE(radius > 0 && radius <= 0.001f);
  EXPECT_EQ(hair.radii[0], 0.001f);
  EXPECT_EQ(scene.materials.at(0).name, "hair");
  EXPECT_EQ(scene.materials[0].alpha, 0.4f);
  EXPECT_EQ(scene.materials.at(1).name, "skin");
  EXPECT_EQ(scene.materials[1].alpha_mode, AlphaMode::opaque);
}

TEST(ProceduralHair, DefaultsToTwentyThousandStrandsOfSixteenSegments) {
  const Scene scene = make_procedural("scene:hair");
  EXPECT_EQ(scene.meshes.at(0).primitive_count(), 320000u);
  EXPECT_EQ(scene.materials.at(0).alpha, 0.3f);
  // In metres, as large as the hair of a human head.
  const Box3f bounds = scene_bounds(scene);
  EXPECT_NEAR(bounds.size().x, 0.35, 0.15);
  EXPECT_NEAR(bounds.size().y, 0.45, 0.15);
}

TEST(ProceduralHair, GrowsFromTheScalpAndStaysOutsideOfTheHead) {
  const Mesh hair = make_procedural("scene:hair?strands=2000&curl=1").meshes.at(0);
  for (std::size_t i = 0; i < hair.positions.size(); ++i) {
    const float distance = head_distance(hair.positions[i]);
    if (i % 17 == 0) {
      EXPECT_NEAR(distance, 1, 1e-4) << i;
      // No strand starts on the face.
      EXPECT_FALSE(hair.positions[i].z > 0.06f && hair.positions[i].y < 0.12f);
    } else {
      EXPECT_GT(distance, 0.999f) << i;
    }
  }
}

TEST(ProceduralHair, EverySegmentHasALength) {
  for (const char* name : {"scene:hair?strands=3000", "scene:hair?strands=500&segments=256&curl=1",
                           "scene:hair?strands=500&segments=1&curl=0"}) {
    const Mesh hair = make_procedural(name).meshes.at(0);
    for (std::size_t s = 0; s < hair.primitive_count(); ++s) {
      const float length =
          (hair.positions[hair.indices[2 * s]] - hair.positions[hair.indices[2 * s + 1]]).length();
      ASSERT_GT(length, 1e-5f) << name << " " << s;
      ASSERT_LT(length, 0.35f) << name << " " << s;
    }
  }
}

TEST(ProceduralHair, TheHeadIsClosedAndFacesOutwards) {
  const Mesh head = make_procedural("scene:hair?strands=1").meshes.at(1);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t t = 0; t < head.primitive_count(); ++t) {
    const std::uint32_t* corner = &head.indices[3 * t];
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{corner[k], corner[(k + 1) % 3]}];
      --edges[{corner[(k + 1) % 3], corner[k]}];
    }
    const V3f a = head.positions[corner[0]], b = head.positions[corner[1]],
              c = head.positions[corner[2]];
    EXPECT_GT((b - a).cross(c - a).dot(a + b + c - kCentre * 3), 0) << t;
  }
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
}

TEST(ProceduralHair, TotalWidthStaysTheSameAsStrandsGrow) {
  const Mesh few = make_procedural("scene:hair?strands=2000").meshes.at(0);
  const Mesh many = make_procedural("scene:hair?strands=20000").meshes.at(0);
  EXPECT_FLOAT_EQ(few.radii[0] * 2000, many.radii[0] * 20000);
}

TEST(ProceduralHair, TheSameSeedGivesTheSameBitsOnAnyNumberOfThreads) {
  const Scene all = make_procedural("scene:hair?strands=3000&seed=4");
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Scene alone = make_procedural("scene:hair?strands=3000&seed=4");
  EXPECT_EQ(all.meshes[0].positions, alone.meshes[0].positions);
  const Scene other = make_procedural("scene:hair?strands=3000&seed=5");
  EXPECT_NE(all.meshes[0].positions, other.meshes[0].positions);
}

TEST(ProceduralHair, MoreSegmentsThanFitAreRefused) {
  try {
    make_procedural("scene:hair?strands=2000000&segments=256");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("at most 67108864 segments"), std::string::npos);
  }
}

}  // namespace
}  // namespace dapple
