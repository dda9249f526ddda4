// Occlusion that is known in closed form: a disk over a point, stacks of sheets, greys, and a
// solid cube that must stay solid from every side.
#include <gtest/gtest.h>

#include "scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

// Rays for AO that is compared with a number. The sampler's (0,2)-nets err by at most the
// strata on the boundary of what occludes: rms about sqrt(3 sqrt(n)) / (2 n) = 2e-4 here.
constexpr int kManyRays = 1 << 16;

float ao_below(const SceneOnDevice& scene, Estimator estimator, float footprint) {
  OcclusionOptions options;
  options.rays = kManyRays;
  options.estimator = estimator;
  options.footprint = footprint;
  return scene.occlusion_at({0, 0, 0}, {0, 1, 0}, options);
}

struct DiskCase {
  double radius, height, opacity;
};

TEST(ClosedForm, ADiskOverAPointOccludesItsFormFactorTimesItsOpacity) {
  for (const DiskCase& c : {DiskCase{1, 1, 1}, DiskCase{1, 1, 0.5}, DiskCase{0.5, 2, 1},
                            DiskCase{3, 0.5, 0.25}, DiskCase{2, 1, 0.85}}) {
    const SceneOnDevice scene(make_procedural("scene:disk?radius=" + std::to_string(c.radius) +
                                              "&height=" + std::to_string(c.height) +
                                              "&opacity=" + std::to_string(c.opacity)));
    const double r2 = c.radius * c.radius;
    const double expected = 1 - c.opacity * r2 / (r2 + c.height * c.height);
    SCOPED_TRACE(testing::Message()
                 << "radius " << c.radius << " height " << c.height << " opacity " << c.opacity);
    // Four times the sampler's rms, and 1e-4 for the 256 segments: (2 pi / 256)^2 / 6.
    EXPECT_NEAR(ao_below(scene, Estimator::exact, 1), expected, 9e-4);
    EXPECT_NEAR(ao_below(scene, Estimator::prefiltered, 1), expected, 1.5e-3);
    // The footprint of 64 rays: a node's opacity is now spread over its box, which reaches
    // beyond the disk's rim by what the 8-bit bounds grew (up to 1/64 of the node) and more
    // where the box is not full. First order cancels, the cosine's change across it does not.
    const float wide = kManyRays / 64.0f;
    const float prefiltered = ao_below(scene, Estimator::prefiltered, wide);
    std::printf("disk %.2f %.2f %.2f: closed form %.5f, wide prefiltered %.5f\n", c.radius,
                c.height, c.opacity, expected, prefiltered);
    EXPECT_NEAR(prefiltered, expected, 0.02);
  }
}

struct StackCase {
  int layers;
  double opacity;
  [[nodiscard]] double transmittance() const { return std::pow(1 - opacity, layers); }
  // Sheets without the ground under them.
  [[nodiscard]] Scene scene() const {
    Scene s;
    s.materials.push_back(material_of(static_cast<float>(opacity)));
    Mesh mesh;
    for (int layer = 0; layer < layers; ++layer) {
      append_grid(mesh, {-1, 0.1f * static_cast<float>(layer), -1}, {2, 0, 0}, {0, 0, 2}, 1, 0);
    }
    place(s, std::move(mesh));
    return s;
  }
};

constexpr StackCase kStacks[] = {{1, 0.25}, {4, 0.25}, {16, 0.1}, {40, 0.05},
                                 {2, 0.85}, {7, 0.5},  {3, 1.0}};

// Straight down over a square of side `side`, a ray a cell, off the quads' diagonals.
std::vector<Ray> rays_down(float side, int cells, float solid_angle) {
  std::vector<Ray> rays;
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const float x = (static_cast<float>(i) + 0.37f) / static_cast<float>(cells) - 0.5f;
      const float z = (static_cast<float>(j) + 0.61f) / static_cast<float>(cells) - 0.5f;
      rays.push_back(make_ray({side * x, 10, side * z}, {0, -1, 0}, solid_angle));
    }
  }
  return rays;
}

TEST(ClosedForm, AStackOfSheetsLetsThroughThePowerOfOneSheet) {
  for (const StackCase& c : kStacks) {
    const SceneOnDevice scene(c.scene());
    const double expected = c.transmittance();
    SCOPED_TRACE(testing::Message() << c.layers << " sheets of opacity " << c.opacity);
    // 40 factors, each rounded to 2^-24.
    for (const Occlusion& found : scene.trace(rays_down(1.98f, 16, 0), Estimator::exact)) {
      ASSERT_NEAR(found.transmittance, expected, 1e-5);
    }
    std::vector<Ray> oblique;
    Points points(1);
    for (int i = 0; i < 256; ++i) {
      const V3f low = points.in_cube(0.95f), high = points.in_cube(0.95f);
      // Enters above the top sheet and leaves below the lowest inside the sheets' square.
      const V3f from(low.x, 4.5f, low.z), to(high.x, -0.5f, high.z);
      oblique.push_back(make_ray(from, to - from));
    }
    for (const Occlusion& found : scene.trace(oblique, Estimator::exact)) {
      ASSERT_NEAR(found.transmittance, expected, 1e-5);
    }
    // Prefiltered spreads the sheets over grown boxes, so only the mean over more than the
    // square says something: opacity * 2^2 / 2.4^2. Opacity codes err by up to 0.004. Boxes
    // grow by up to 1/64 an axis, and where k sheets are k nodes, k thinner layers over a
    // larger area occlude more: by k/32 * a * T, at most 0.02 for all of these.
    const double area = 2.4 * 2.4;
    const double mean =
        mean_transmittance(scene.trace(rays_down(2.4f, 96, 1e3f), Estimator::prefiltered));
    std::printf("stack %d of %.2f: closed form %.5f, prefiltered mean %.5f\n", c.layers, c.opacity,
                1 - (1 - expected) * 4 / area, mean);
    EXPECT_NEAR(mean, 1 - (1 - expected) * 4 / area, 0.02);
  }
}

TEST(ClosedForm, AQuarterAndAHalfGreyLetThroughThreeEighths) {
  Scene scene = make_procedural("scene:greys");
  const auto grey_rays = [] {
    std::vector<Ray> rays = rays_down(1.98f, 16, 0);
    for (Ray& ray : rays) ray.t_max = 9.95f;  // the ground is at 10
    return rays;
  };
  const SceneOnDevice two_level(scene);
  merge_single_instances(scene);
  const SceneOnDevice merged(scene);
  for (const SceneOnDevice* traced : {&two_level, &merged}) {
    for (const Occlusion& found : traced->trace(grey_rays(), Estimator::exact)) {
      ASSERT_NEAR(found.transmittance, 0.75 * 0.5, 1e-6);
    }
    for (const Occlusion& found : traced->trace(rays_down(1.98f, 16, 0), Estimator::exact)) {
      ASSERT_EQ(found.transmittance, 0.0f);
    }
  }
}

// From all around a cube of side 1 to places in its inner 90 %: a tenth is where boxes that
// 8-bit bounds grew by up to 1/64 let the rays in front of their rim pass.
std::vector<Ray> rays_into_cube(float solid_angle) {
  Points points(7);
  std::vector<Ray> rays;
  for (int i = 0; i < 20000; ++i) {
    const V3f from = V3f(0, 0.5f, 0) + points.on_sphere() * 5.0f;
    rays.push_back(make_ray(from, V3f(0, 0.5f, 0) + points.in_cube(0.45f) - from, solid_angle));
  }
  return rays;
}

TEST(SolidCube, IsOpaqueFromEveryDirectionWhateverTheFootprint) {
  for (const char* name : {"scene:cube", "scene:cube?divisions=3", "scene:cube?divisions=50"}) {
    SCOPED_TRACE(name);
    const SceneOnDevice cube(make_procedural(name));
    for (const Occlusion& found : cube.trace(rays_into_cube(0), Estimator::exact)) {
      ASSERT_EQ(found.transmittance, 0.0f);
    }
    // At scale 1 nodes of side 0.2 are covered, at 16 the root's children and at 64 all.
    for (const float scale : {1.0f, 4.0f, 16.0f, 64.0f}) {
      const std::vector<Occlusion> found =
          cube.trace(rays_into_cube(0.04f / 25), Estimator::prefiltered, scale);
      float largest = 0;
      int above = 0;
      for (const Occlusion& one : found) {
        largest = std::max(largest, one.transmittance);
        above += one.transmittance >= 0.02f;
      }
      std::printf("%s, footprint scale %g: mean %.5f largest %.5f, %d above 0.02\n", name, scale,
                  mean_transmittance(found), largest, above);
      EXPECT_LT(largest, 0.02f) << "footprint scale " << scale;
    }
  }
}

}  // namespace
}  // namespace dapple
