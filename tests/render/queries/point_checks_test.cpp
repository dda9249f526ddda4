// occlusion(), irradiance() and measure_points() refuse points, normals, suns and options that say
// nothing, and name them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "dapple/error.hpp"
#include "dapple/points.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Scene square() {
  Scene scene;
  scene.materials.push_back(material_of(1));
  place(scene, square_mesh(1, 1, 1, 0));
  return scene;
}

template <class Call>
void expect_usage_error(const std::string& part, const Call& call) {
  try {
    call();
    ADD_FAILURE() << "no error: " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

struct WrongPoint {
  V3f point, normal;
  const char* message;
};

// The wrong one is the last of many, which several threads check.
TEST(PointChecks, WrongPointsAndNormalsAreNamed) {
  const WrongPoint wrong[] = {
      {{kNan, 0, 0}, {0, 1, 0}, "point 9999 has a coordinate that is not finite: (nan, 0, 0)"},
      {{0, kInfinity, 0}, {0, 1, 0}, "point 9999 has a coordinate that is not finite: (0, inf, 0)"},
      {{0, 0, 0}, {0, 2, 0}, "the normal of point 9999 is not a unit vector: (0, 2, 0)"},
      {{0, 0, 0}, {0, 0, 0}, "the normal of point 9999 is not a unit vector: (0, 0, 0)"},
      {{0, 0, 0}, {kNan, 1, 0}, "the normal of point 9999 is not a unit vector: (nan, 1, 0)"}};
  const SceneOnDevice scene(square());
  for (const WrongPoint& one : wrong) {
    std::vector<V3f> points(10000, V3f(0, 0, 0)), normals(10000, V3f(0, 1, 0));
    points.back() = one.point;
    normals.back() = one.normal;
    expect_usage_error(std::string("occlusion: ") + one.message,
                       [&] { occlusion(device(), scene.uploaded, points, normals); });
    expect_usage_error(std::string("irradiance: ") + one.message,
                       [&] { irradiance(device(), scene.uploaded, {}, points, normals); });
    expect_usage_error(one.message, [&] { measure_points(scene.scene, points, normals); });
  }
}

// Documents name them; at points the noise of few rays counts more than bias (experiment 640).
TEST(PointChecks, DefaultFootprintsAreThoseOfTheDocuments) {
  EXPECT_EQ(OcclusionOptions().footprint, 8);
  EXPECT_EQ(IrradianceOptions().footprint, 4);
}

TEST(PointChecks, OptionsOfOcclusionHaveRanges) {
  const SceneOnDevice scene(square());
  const std::pair<OcclusionOptions, const char*> wrong[] = {
      {{.footprint = -1}, "footprint is -1"},
      {{.footprint = kNan}, "footprint is nan"},
      {{.distance = -1}, "distance is -1"},
      {{.distance = kNan}, "distance is nan"},
      {{.distance = 1, .falloff = 101}, "falloff is 101; it must be from 0 to 100"},
      {{.falloff = 1}, "falloff needs a distance"}};
  for (const auto& [options, message] : wrong)
    expect_usage_error(std::string("occlusion: ") + message, [&] {
      std::ignore = scene.occlusion_at({0, 0, 0}, {0, 1, 0}, options);
    });
}

TEST(PointChecks, SunsHaveAUnitDirectionAndAnIrradiance) {
  const std::pair<SunDirection, const char*> wrong[] = {
      {{{0, 3, 0}, 1}, "the direction of sun 1 is not a unit vector: (0, 3, 0)"},
      {{{0, 0, 0}, 1}, "the direction of sun 1 is not a unit vector: (0, 0, 0)"},
      {{{kNan, 1, 0}, 1}, "the direction of sun 1 is not a unit vector: (nan, 1, 0)"},
      {{{0, 1, 0}, -1}, "the irradiance of sun 1 is -1"},
      {{{0, 1, 0}, kNan}, "the irradiance of sun 1 is nan"},
      {{{0, 1, 0}, kInfinity}, "the irradiance of sun 1 is inf"}};
  const std::vector<V3f> point{{0, 0, 0}}, up{{0, 1, 0}};
  for (const auto& [sun, message] : wrong) {
    PointOptions options;
    options.suns = {{}, sun};
    expect_usage_error(message, [&] { measure_points(square(), point, up, options); });
  }
}

}  // namespace
}  // namespace dapple
