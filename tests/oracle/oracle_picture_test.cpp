// Compares whole pictures of the exact estimator with Embree's: AO and the light of a rect.
#include "oracle/oracle_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "camera/view.hpp"
#include "oracle/oracle_scenes.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple::oracle {
namespace {

using test::set_smooth_normals;
using test::smooth_torus;

constexpr int kSide = 96;  // pixels
constexpr int kBlock = 8;  // pixels; side of the squares that are compared one by one
constexpr int kSpp = 128;

struct OursAndTheirs {
  std::vector<double> ao, light;  ///< ours; the light as in Picture
  Picture oracle;
};

std::vector<double> scaled(const Plane& plane, double scale) {
  std::vector<double> values(plane.pixels.begin(), plane.pixels.end());
  for (double& value : values) value *= scale;
  return values;
}

/// Looks down at the plant, so that plant and ground fill the picture; the sky would test nothing.
LookAt close_look(const Box3f& box) {
  const float height = box.size().y;
  return {box.center() + V3f(0.2f, 0.7f, 1.0f) * height, box.center() - V3f(0, 0.2f, 0) * height};
}

/// A rect light near the plant's side, turned slightly away from it, so that both cosines and the
/// distance vary over the picture.
Light side_light(const Box3f& box) {
  const float radius = box.size().length() / 2;
  Light light;
  light.name = "rect";
  light.position = box.center() + V3f(-0.6f, 0.8f, 0.5f) * (1.3f * radius);
  light.direction = V3f(0.2f, -1, 0.1f).normalized();
  light.edge_u = light.direction.cross(V3f(0, 0, 1)).normalized() * radius;
  light.edge_v = light.direction.cross(light.edge_u) * 0.5f;
  light.radiance = V3f(3, 3, 3);
  return light;
}

OursAndTheirs draw_both(Scene scene) {
  RenderOptions options;
  options.width = options.height = kSide;
  options.spp = kSpp;
  options.estimator = Estimator::exact;
  options.ground = true;
  options.look = close_look(scene_bounds(scene));
  std::vector<std::string> notes;
  const Camera camera = choose_view(scene, options, notes).camera;
  const Light light = side_light(scene_bounds(scene));
  scene.lights = {light};
  Scene grounded = scene;
  add_ground(grounded);
  const Picture oracle = draw(EmbreeOracle(grounded), camera, kSide, kSide, kSpp, light, 7);
  const Film film = render(std::move(scene), options).film;
  return {scaled(*film.find("ao.R"), 1),
          scaled(*film.find("light.rect.R"), 1 / (light.radiance.x * oracle.brightest)), oracle};
}

/// The largest difference of a block's means, in standard errors of the oracle's mean. In a nearly
/// empty block the estimated variance may be too small for a single sample that hits, so the
/// variance of one sample of full weight is added.
double worst_block(const std::vector<double>& ours, const Estimate& theirs) {
  constexpr int kBlocks = kSide / kBlock;
  double worst = 0;
  for (int block = 0; block < kBlocks * kBlocks; ++block) {
    const int x0 = kBlock * (block % kBlocks), y0 = kBlock * (block / kBlocks);
    double difference = 0, variance = 1.0 / (kSpp * kSpp);
    for (int i = 0; i < kBlock * kBlock; ++i) {
      const auto pixel = static_cast<std::size_t>((y0 + i / kBlock) * kSide + x0 + i % kBlock);
      difference += ours[pixel] - theirs.pixels[pixel];
      variance += theirs.variances[pixel];
    }
    worst = std::max(worst, std::fabs(difference) / std::sqrt(variance));
  }
  return worst;
}

double mean(const std::vector<double>& values) { return Estimate{values, {}}.mean(); }

void expect_equal(const char* scene, const char* quantity, const std::vector<double>& ours,
                  const Estimate& theirs) {
  const double worst = worst_block(ours, theirs);
  std::printf("%s, %s: ours %.5f, Embree %.5f +- %.5f, difference %+.5f, worst block %.1f\n", scene,
              quantity, mean(ours), theirs.mean(), theirs.standard_error(),
              mean(ours) - theirs.mean(), worst);
  EXPECT_LE(theirs.standard_error(), 0.0005) << "too few samples to tell";
  EXPECT_NEAR(mean(ours), theirs.mean(), 0.002) << scene << ", " << quantity;
  // The difference of two estimates with equal errors has sqrt(2) times their standard error. The
  // largest of 144 normal values is beyond 4.5 deviations once in a thousand pictures.
  EXPECT_LE(worst, 4.5 * std::sqrt(2.0)) << scene << ", " << quantity;
}

void expect_equal_pictures(const char* name, const Scene& scene) {
  const OursAndTheirs pictures = draw_both(scene);
  expect_equal(name, "AO", pictures.ao, pictures.oracle.ao);
  expect_equal(name, "light", pictures.light, pictures.oracle.light);
}

}  // namespace

TEST(OraclePicture, ATreeHasEmbreesOcclusionAndLight) {
  expect_equal_pictures("tree", load_scene("scene:tree?leaves=3000"));
}

TEST(OraclePicture, TheSaplingHasEmbreesOcclusionAndLight) {
  DAPPLE_SKIP_WITHOUT(shared_scene("sapling_100k.glb"));
  expect_equal_pictures("sapling", load_sapling());
}

TEST(OraclePicture, ASmoothTorusHasEmbreesOcclusionAndLight) {
  expect_equal_pictures("torus", smooth_torus(50, 20));
}

TEST(OraclePicture, TheSaplingWithSmoothNormalsHasEmbreesOcclusionAndLight) {
  DAPPLE_SKIP_WITHOUT(shared_scene("sapling_100k.glb"));
  Scene sapling = load_sapling();
  for (Mesh& mesh : sapling.meshes) set_smooth_normals(mesh);
  expect_equal_pictures("smooth sapling", sapling);
}

// As foliage often has them; backs of leaves have normals that face away from the viewer.
TEST(OraclePicture, LeavesWithTheNormalsOfASphereHaveEmbreesOcclusionAndLight) {
  Scene cloud = load_scene("scene:cloud?leaves=300");
  for (Mesh& mesh : cloud.meshes) {
    const V3f middle = scene_bounds(cloud).center();
    mesh.normals.clear();
    for (const V3f& position : mesh.positions)
      mesh.normals.push_back((position - middle).normalized());
  }
  expect_equal_pictures("cloud", cloud);
}

TEST(OraclePicture, TheTexturedPineHasEmbreesOcclusionAndLight) {
  DAPPLE_SKIP_WITHOUT(shared_scene("smallpine"));
  expect_equal_pictures("pine", load_pine());
}

}  // namespace dapple::oracle
