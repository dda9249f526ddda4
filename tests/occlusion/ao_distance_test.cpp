// AO with a maximum distance and a falloff: surfaces beyond the distance do not count, nearer ones
// do, and the AO under an infinite plane equals the closed-form integral.
#include <gtest/gtest.h>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

// Enough rays for an rms error of about 2e-4; see closed_form_test.cpp.
OcclusionOptions many_rays(Estimator estimator, double distance, double falloff) {
  OcclusionOptions options;
  options.rays = 1 << 16;
  options.estimator = estimator;
  options.distance = static_cast<float>(distance);
  options.falloff = static_cast<float>(falloff);
  return options;
}

TEST(AoDistance, OnlyADiskNearerThanTheDistanceOccludes) {
  const SceneOnDevice scene(make_procedural("scene:disk?radius=1&height=1&opacity=1"));
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const auto ao = [&](double distance) {
      return scene.occlusion_at({0, 0, 0}, {0, 1, 0}, many_rays(estimator, distance, 0));
    };
    EXPECT_EQ(ao(0.999), 1.0f);
    EXPECT_NEAR(ao(1.5), 0.5, 1.5e-3);  // the rim is at sqrt(2)
    // Only the part with cos > h / D counts: a disk of radius sqrt(D^2 - h^2) occludes 1 - (h/D)^2.
    EXPECT_NEAR(ao(1.25), 1.0 / (1.25 * 1.25), 1.5e-3);
  }
}

// AO under a plane: 1 - a times the integral from k to 1 of 2 c (1 - k / c)^p dc, where a is the
// opacity, c the cosine and k = h / D.
double plane_ao(double opacity, double k, int power) {
  const double part = power == 0   ? 1 - k * k
                      : power == 1 ? (1 - k) * (1 - k)
                                   : 1 - k * k - 4 * k * (1 - k) - 2 * k * k * std::log(k);
  return 1 - opacity * part;
}

TEST(AoDistance, APlaneOverheadFallsOffAsItsIntegral) {
  for (const float opacity : {1.0f, 0.4f}) {
    Scene ceiling;
    ceiling.materials.push_back(material_of(opacity));
    place(ceiling, square_mesh(64, 1, 128, 0));  // reaches beyond every D below
    const SceneOnDevice scene(std::move(ceiling));
    for (const double distance : {1.5, 3.0, 7.5, 15.0}) {
      for (const int power : {0, 1, 2}) {
        SCOPED_TRACE(testing::Message()
                     << "opacity " << opacity << " distance " << distance << " power " << power);
        const double expected = plane_ao(opacity, 1 / distance, power);
        const auto ao = [&](Estimator estimator, float footprint) {
          OcclusionOptions options = many_rays(estimator, distance, power);
          options.footprint = footprint;
          return scene.occlusion_at({0, 0, 0}, {0, 1, 0}, options);
        };
        // Without falloff the edge at D is sharp: 2e-4 rms. With falloff the error is smaller.
        EXPECT_NEAR(ao(Estimator::exact, 1), expected, 9e-4);
        EXPECT_NEAR(ao(Estimator::prefiltered, 1), expected, 2e-3);
        // Footprints as of 64 rays: a node counts as if it were at its middle. 8-bit bounds enlarge
        // a node by up to 2 of its 64 to 127 steps an axis, and its opacity is that of the larger
        // box: 3 to 6 % less. Overlapping neighbours compensate part of this.
        EXPECT_NEAR(ao(Estimator::prefiltered, 1024), expected, 0.04);
      }
    }
  }
}

TEST(AoDistance, APlaneWithATextureFallsOffAsOneOfTheSameOpacity) {
  Scene ceiling;
  ceiling.textures.push_back({"even", 4, 4, std::vector<std::uint8_t>(16, 102)});
  Material material = material_of(1);
  material.alpha_texture = 0;
  ceiling.materials.push_back(material);
  Mesh plane = square_mesh(64, 1, 128, 0);
  for (const V3f& at : plane.positions) plane.uvs.emplace_back(at.x, at.z);
  place(ceiling, std::move(plane));
  const SceneOnDevice scene(std::move(ceiling));
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const float ao = scene.occlusion_at({0, 0, 0}, {0, 1, 0}, many_rays(estimator, 3, 2));
    // 102 of 255 is 0.4; tolerance as above.
    EXPECT_NEAR(ao, plane_ao(0.4, 1.0 / 3, 2), 2e-3);
  }
}

TEST(AoDistance, ANodeThatHoldsTheRaysEndIsOpenedAtEveryDistance) {
  int wrong = 0;
  const auto check = [&](float distance) {
    const SquareBeyond square(distance);
    const SceneOnDevice traced(square.scene);
    const std::vector<Ray> rays{make_ray(square.origin, {0, 1, 0}, 6, distance)};
    const float found = traced.trace(rays, Estimator::prefiltered, 1e6f)[0].transmittance;
    EXPECT_EQ(found, 1.0f) << "distance " << distance;
    wrong += found != 1.0f;
  };
  for (const float distance : {0.5f, 1.0f, 1.375f, 2.0f, 3.0f, 3.75f, 5.5f, 7.5f, 10.0f, 11.0f,
                               15.0f, 22.0f, 30.0f, 100.0f}) {
    check(distance);
  }
  Points points(3);
  for (int i = 0; i < 50; ++i) check(std::exp(8 * points.unit() - 4));
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace dapple
