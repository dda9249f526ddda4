// Occlusion that is known in closed form: a disk over a point, stacks of sheets, two grey sheets,
// and a solid cube that must be opaque from every side.
#include <gtest/gtest.h>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

// Number of rays for AO that is compared with a number. With (0,2)-nets only the strata on the
// occluder's boundary cause errors: rms about sqrt(3 sqrt(n)) / (2 n) = 2e-4 here.
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
    // Four times the sampler's rms, and 1e-4 for the disk's 256 segments: (2 pi / 256)^2 / 6.
    EXPECT_NEAR(ao_below(scene, Estimator::exact, 1), expected, 9e-4);
    EXPECT_NEAR(ao_below(scene, Estimator::prefiltered, 1), expected, 1.5e-3);
    // The footprint of 64 rays covers nodes of single triangles. Boxes of neighbouring triangles
    // overlap, and their transmittances are multiplied as if they were independent: two triangles
    // that fill a square transmit a quarter. So up to half of the disk's occlusion may be lost.
    const float wide = kManyRays / 64.0f;
    const float prefiltered = ao_below(scene, Estimator::prefiltered, wide);
    std::printf("disk %.2f %.2f %.2f: closed form %.5f, wide prefiltered %.5f\n", c.radius,
                c.height, c.opacity, expected, prefiltered);
    EXPECT_NEAR(prefiltered, expected, 0.03);
  }
}

struct StackCase {
  int layers;
  double opacity;
  [[nodiscard]] double transmittance() const { return std::pow(1 - opacity, layers); }
  // The sheets, without a ground under them.
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

// Rays straight down over a square of side `side`, one a cell, not on the quads' diagonals.
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

TEST(ClosedForm, AStackOfSheetsTransmitsThePowerOfOneSheet) {
  for (const StackCase& c : kStacks) {
    const SceneOnDevice scene(c.scene());
    const double expected = c.transmittance();
    SCOPED_TRACE(testing::Message() << c.layers << " sheets of opacity " << c.opacity);
    // At most 40 factors, each rounded to 2^-24.
    for (const Occlusion& found : scene.trace(rays_down(1.98f, 16, 0), Estimator::exact)) {
      ASSERT_NEAR(found.transmittance, expected, 1e-5);
    }
    std::vector<Ray> oblique;
    Points points(1);
    for (int i = 0; i < 256; ++i) {
      const V3f low = points.in_cube(0.95f), high = points.in_cube(0.95f);
      // The ray starts above the top sheet and crosses all sheets inside their square.
      const V3f from(low.x, 4.5f, low.z), to(high.x, -0.5f, high.z);
      oblique.push_back(make_ray(from, to - from));
    }
    for (const Occlusion& found : scene.trace(oblique, Estimator::exact)) {
      ASSERT_NEAR(found.transmittance, expected, 1e-5);
    }
    // Prefiltering spreads the sheets over boxes that are slightly larger. So the mean over a
    // larger square is compared: opacity * 2^2 / 2.4^2. Stored opacities are off by up to 0.004.
    // Boxes grow by up to 1/64 an axis, and where k sheets are k nodes, k thinner layers over a
    // larger area occlude more: by k/32 * a * T, at most 0.02 in all of these cases.
    const double area = 2.4 * 2.4;
    const double mean =
        mean_transmittance(scene.trace(rays_down(2.4f, 96, 1e3f), Estimator::prefiltered));
    std::printf("stack %d of %.2f: closed form %.5f, prefiltered mean %.5f\n", c.layers, c.opacity,
                1 - (1 - expected) * 4 / area, mean);
    EXPECT_NEAR(mean, 1 - (1 - expected) * 4 / area, 0.02);
  }
}

TEST(ClosedForm, OpacitiesOfAQuarterAndAHalfTransmitThreeEighths) {
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

// Rays parallel to `direction` through the inner 90 % of the cube. The rest is left out: there,
// boxes that 8-bit bounds enlarged by up to 1/64 are not opaque at their edges.
std::vector<Ray> rays_into_cube(const V3f& direction, float solid_angle) {
  Points points(7);
  std::vector<Ray> rays;
  for (int i = 0; i < 400; ++i) {
    const V3f at = V3f(0, 0.5f, 0) + points.in_cube(0.45f);
    rays.push_back(make_ray(at - direction * 5.0f, direction, solid_angle));
  }
  return rays;
}

// Directions along faces, edges and diagonals, and 60 random ones.
std::vector<V3f> directions_all_around() {
  std::vector<V3f> directions;
  for (int i = 0; i < 27; ++i) {
    const V3f d(static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1),
                static_cast<float>(i / 9 - 1));
    if (d.length() > 0) directions.push_back(d.normalized());
  }
  Points points(8);
  while (directions.size() < 86) directions.push_back(points.on_sphere());
  return directions;
}

TEST(SolidCube, IsOpaqueFromEveryDirectionWhateverTheFootprint) {
  for (const char* name : {"scene:cube", "scene:cube?divisions=3", "scene:cube?divisions=50"}) {
    const SceneOnDevice cube(make_procedural(name));
    // Footprints of a twentieth, a fifth and four fifths of a face, and of more than a face.
    for (const float scale : {1.0f, 4.0f, 16.0f, 64.0f}) {
      double worst = 0, sum = 0;
      V3f where;
      for (const V3f& direction : directions_all_around()) {
        const std::vector<Ray> rays = rays_into_cube(direction, 0.05f / 25);
        for (const Occlusion& found : cube.trace(rays, Estimator::exact)) {
          ASSERT_EQ(found.transmittance, 0.0f) << direction;
        }
        const double mean = mean_transmittance(cube.trace(rays, Estimator::prefiltered, scale));
        sum += mean;
        if (mean > worst) where = direction;
        worst = std::max(worst, mean);
      }
      std::printf("%s, footprint scale %g: mean %.4f, worst %.4f along %.2f %.2f %.2f\n", name,
                  scale, sum / 86, worst, where.x, where.y, where.z);
      EXPECT_LT(worst, 0.02) << name << " at footprint scale " << scale << " along " << where;
    }
  }
}

// Prefiltering must keep the occluded area; only its edge may be blurred.
TEST(SolidCube, OccludesItsSilhouetteWhateverTheFootprint) {
  const SceneOnDevice cube(make_procedural("scene:cube"));
  const std::vector<Ray> rays = rays_across(cube.bvh.bounds, 40000, 0.05f / 9, 9);
  // A convex body's mean silhouette is a quarter of its surface (Cauchy): 6/4 of pi (3/4). Four
  // standard deviations of 40,000 rays are 0.01.
  const double expected = 1.5 / (kPi * 0.75);
  EXPECT_NEAR(1 - mean_transmittance(cube.trace(rays, Estimator::exact)), expected, 0.01);
  for (const float scale : {1.0f, 4.0f, 16.0f, 64.0f}) {
    const double found = 1 - mean_transmittance(cube.trace(rays, Estimator::prefiltered, scale));
    std::printf("cube's silhouette at scale %g: %.4f of %.4f\n", scale, found, expected);
    EXPECT_NEAR(found, expected, 0.03) << scale;
  }
}

}  // namespace
}  // namespace dapple
