// measure_points() against closed forms: canopies of randomly placed leaves (Ross 1981), a
// ball of leaves, a wall, rings of the sky, suns and skies.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "dapple/error.hpp"
#include "dapple/points.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr float kLeaf = 0.05f;  // side of a square leaf

void append_leaf(Mesh& mesh, const V3f& centre, scene_test::Points& random) {
  const V3f normal = random.on_sphere();
  const V3f u = normal.cross(random.on_sphere()).normalized() * (kLeaf / 2);
  const V3f v = normal.cross(u);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const V3f& corner : {u + v, u - v, -u - v, v - u}) mesh.positions.push_back(centre + corner);
  mesh.indices.insert(mesh.indices.end(),
                      {first, first + 1, first + 2, first, first + 2, first + 3});
  mesh.materials.insert(mesh.materials.end(), {0, 0});
}

Scene scene_of(Mesh mesh, float opacity) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].alpha = opacity;
  scene.meshes = {std::move(mesh)};
  scene.instances.resize(1);
  return scene;
}

constexpr float kPeriod = 4, kBottom = 0.5f, kTop = 2.5f;

/// Leaves with spherical angles, leaf area index `area_index`, in a slab that repeats itself.
Scene canopy(double area_index, float opacity, unsigned seed = 7) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<float> along(0, kPeriod), up(kBottom, kTop);
  scene_test::Points random(5);
  Mesh mesh;
  const auto leaves =
      static_cast<int>(area_index * double{kPeriod * kPeriod} / double{kLeaf * kLeaf} + 0.5);
  for (int i = 0; i < leaves; ++i) {
    const float x = along(bits), z = along(bits), y = up(bits);
    append_leaf(mesh, V3f(x, y, z), random);
  }
  return scene_of(std::move(mesh), opacity);
}

std::vector<V3f> ground_points(int side) {
  std::vector<V3f> points;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      points.emplace_back((static_cast<float>(i) + 0.5f) * kPeriod / static_cast<float>(side), 0.0f,
                          (static_cast<float>(j) + 0.5f) * kPeriod / static_cast<float>(side));
  return points;
}

double mean_of(const PointResult& result, const std::string& name) {
  for (const PointColumn& column : result.columns) {
    if (column.name != name) continue;
    double sum = 0;
    for (const float value : column.values) sum += double{value};
    return sum / static_cast<double>(column.values.size());
  }
  ADD_FAILURE() << "no column " << name;
  return 0;
}

PointResult measure(const Scene& scene, const std::vector<V3f>& points, PointOptions options) {
  return measure_points(scene, points, std::vector<V3f>(points.size(), V3f(0, 1, 0)), options);
}

PointOptions periodic(Estimator estimator) {
  PointOptions options;
  options.estimator = estimator;
  options.period_x = options.period_z = kPeriod;
  return options;
}

// Ross 1981: the transmittance of random leaves with spherical angles is exp(-a L / (2 cos)). Its
// mean over the cosine-weighted hemisphere is 2 E3(a L / 2).
TEST(PointTheory, TheSkyViewFactorUnderARandomCanopyIsThatOfTheory) {
  struct Case {
    double area_index, opacity, expected;
  };
  const Case cases[] = {{1, 1, 0.44321},    {2, 1, 0.21938},    {3, 1, 0.11348},
                        {4, 1, 0.06027},    {1, 0.85, 0.49553}, {2, 0.85, 0.26932},
                        {3, 0.85, 0.15206}, {4, 0.85, 0.08787}, {1, 0.2, 0.83258},
                        {2, 0.2, 0.70389},  {3, 0.2, 0.60008},  {4, 0.2, 0.51457}};
  for (const Case& c : cases) {
    const Scene scene = canopy(c.area_index, static_cast<float>(c.opacity));
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      const double found =
          mean_of(measure(scene, ground_points(32), periodic(estimator)), "sky_view_factor");
      std::printf("L %.0f, opacity %.2f, %s: %.5f, theory %.5f\n", c.area_index, c.opacity,
                  estimator == Estimator::exact ? "exact" : "prefiltered", found, c.expected);
      EXPECT_NEAR(found, c.expected, estimator == Estimator::exact ? 0.003 : 0.006)
          << c.area_index << ", " << c.opacity;
    }
  }
}

/// Horizontal leaves, leaf area index 1, in a thin layer that repeats itself: a gap fraction of
/// exp(-1) in all directions.
Scene thin_canopy() {
  std::mt19937 bits(3);
  std::uniform_real_distribution<float> along(0, kPeriod), up(2, 2.2f);
  Mesh mesh;
  const int leaves = static_cast<int>(kPeriod * kPeriod / (kLeaf * kLeaf) + 0.5f);
  for (int i = 0; i < leaves; ++i) {
    const float x = along(bits), z = along(bits), y = up(bits);
    append_grid(mesh, {x, y, z}, {kLeaf, 0, 0}, {0, 0, kLeaf}, 1, 0);
  }
  return scene_of(std::move(mesh), 1);
}

// Copies that reach only as far as the layer's own height needs give an AO of 0.39. The ninth ring
// ends at the horizon, where rays may leave the copies.
TEST(PointTheory, AThinCanopyFarAboveThePointsHasItsGapFractionInAllRings) {
  PointOptions options = periodic(Estimator::exact);
  options.rings = 9;
  const PointResult found = measure(thin_canopy(), ground_points(32), options);
  for (const char* name : {"ao", "sky_view_factor", "gap_1", "gap_4", "gap_7", "gap_8"})
    EXPECT_NEAR(mean_of(found, name), std::exp(-1.0), 0.006) << name;
}

TEST(PointTheory, PointsBelowCopiesOfACanopyHaveTheValuesBelowIt) {
  const Scene scene = canopy(2, 1);
  std::vector<V3f> points = ground_points(8);
  const PointOptions options = periodic(Estimator::prefiltered);
  const PointResult inside = measure(scene, points, options);
  for (V3f& point : points) point += V3f(25 * kPeriod, 0, -25 * kPeriod);
  const PointResult outside = measure(scene, points, options);
  for (const char* name : {"ao", "sky_view_factor"})
    EXPECT_NEAR(mean_of(outside, name), mean_of(inside, name), 1e-4) << name;
}

// The mean of exp(-L / (2 cos)) over a ring, uniform by solid angle: by cos. Rings see fewer leaves
// of the one canopy than the whole sky does: exact values of the innermost one err by 0.0034.
TEST(PointTheory, GapFractionsUnderARandomCanopyAreThoseOfTheory) {
  constexpr double kAreaIndex = 2;
  const double degrees[5][2] = {{0, 13}, {16, 28}, {32, 43}, {47, 58}, {61, 74}};
  const Scene scene = canopy(kAreaIndex, 1);
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    PointOptions options = periodic(estimator);
    options.ao = options.sky_view_factor = false;
    options.rings = 5;
    const PointResult found = measure(scene, ground_points(32), options);
    EXPECT_EQ(found.notes.size(), estimator == Estimator::exact ? 0u : 5u);
    for (int ring = 0; ring < 5; ++ring) {
      const double inner = std::cos(degrees[ring][0] * kPi / 180),
                   outer = std::cos(degrees[ring][1] * kPi / 180);
      double expected = 0;
      for (int i = 0; i < 1000; ++i)
        expected += std::exp(-kAreaIndex / 2 / (outer + (inner - outer) * (i + 0.5) / 1000)) / 1000;
      EXPECT_NEAR(mean_of(found, "gap_" + std::to_string(ring + 1)), expected,
                  estimator == Estimator::exact ? 0.004 : 0.006)
          << ring;
    }
  }
}

TEST(PointTheory, PrefilteredValuesAreCorrectedByExactOnesAndSaySo) {
  Scene scene = canopy(2, 1);
  scene.lights = {uniform_sky()};
  const PointResult found = measure(scene, ground_points(32), periodic(Estimator::prefiltered));
  ASSERT_EQ(found.notes.size(), 3u);
  EXPECT_NE(found.notes[1].find("sky_view_factor was 0.0"), std::string::npos) << found.notes[1];
  EXPECT_NEAR(mean_of(found, "sky_r"), 0.21938, 0.006);
  PointOptions options = periodic(Estimator::exact);
  options.sky_view_factor = false;
  EXPECT_TRUE(measure(scene, ground_points(4), options).notes.empty());
}

// One canopy is a sample of 12,800 leaves, whose transmittance deviates by about 0.004.
TEST(PointTheory, ASunAtTwentyDegreesFromTheZenithIsAttenuatedByTheBeerLambertLaw) {
  const double zenith = 20 * kPi / 180;
  PointOptions options;
  for (int i = 0; i < 36; ++i) {
    const double around = i * kPi / 18;
    options.suns.push_back({V3f(static_cast<float>(std::sin(zenith) * std::cos(around)),
                                static_cast<float>(std::cos(zenith)),
                                static_cast<float>(std::sin(zenith) * std::sin(around))),
                            100});
  }
  options.period_x = options.period_z = kPeriod;
  options.sky_view_factor = options.ao = false;
  constexpr unsigned kCanopies = 24;
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    options.estimator = estimator;
    double found = 0;
    for (unsigned seed = 1; seed <= kCanopies; ++seed)
      found += mean_of(measure(canopy(2, 1, seed), ground_points(16), options), "sun") / kCanopies;
    EXPECT_NEAR(found / (36 * 100 * std::cos(zenith)), 0.34501,
                estimator == Estimator::exact ? 0.003 : 0.006);
  }
}

/// Leaves in the unit ball around (0, 2, 0), with `extinction` per metre: half of their area per
/// volume.
Mesh ball(double extinction, unsigned seed) {
  scene_test::Points random(seed);
  std::mt19937 bits(seed);
  std::uniform_real_distribution<float> along(-1, 1);
  Mesh mesh;
  const int leaves = static_cast<int>(2 * extinction * 4.0 / 3 * kPi / double{kLeaf * kLeaf});
  for (int i = 0; i < leaves;) {
    const float x = along(bits), y = along(bits), z = along(bits);
    const V3f p(x, y, z);
    if (p.length() > 1) continue;
    append_leaf(mesh, p + V3f(0, 2, 0), random);
    ++i;
  }
  return mesh;
}

// The mean transmittance over the disc of a ball's shadow. One ball is a sample of 3,351 leaves,
// and these reach a little out of it.
TEST(PointTheory, ABallOfLeavesHasItsMeanTransmittance) {
  constexpr double kExtinction = 1, kDepth = 2 * kExtinction;  // through its middle
  std::vector<V3f> disc;
  for (int i = 0; i < 4000; ++i) {
    const double radius = std::sqrt((i + 0.5) / 4000), angle = i * 2.399963;
    disc.emplace_back(static_cast<float>(radius * std::cos(angle)), 0.0f,
                      static_cast<float>(radius * std::sin(angle)));
  }
  PointOptions options;
  options.ao = options.sky_view_factor = false;
  options.suns = {{V3f(0, 1, 0), 1}};
  const double expected = 2 * (1 - (1 + kDepth) * std::exp(-kDepth)) / (kDepth * kDepth);
  constexpr unsigned kBalls = 16;
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    options.estimator = estimator;
    double found = 0;
    for (unsigned seed = 1; seed <= kBalls; ++seed)
      found +=
          mean_of(measure(scene_of(ball(kExtinction, seed), 1), disc, options), "sun") / kBalls;
    EXPECT_NEAR(found, expected, 0.004);
  }
}

TEST(PointTheory, APointBeforeALongWallSeesWhatIsAboveIt) {
  constexpr double kHeight = 3;
  for (const double distance : {0.5, 2.0, 6.0}) {
    Mesh wall;
    append_grid(wall, {static_cast<float>(distance), 0, -1e4f}, {0, static_cast<float>(kHeight), 0},
                {0, 0, 2e4f}, 8, 0);
    const double expected = (1 + 1 / std::sqrt(1 + std::pow(kHeight / distance, 2))) / 2;
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      PointOptions options;
      options.estimator = estimator;
      options.rays = 2048;
      const PointResult found = measure(scene_of(wall, 1), {V3f(0, 0, 0)}, options);
      EXPECT_NEAR(mean_of(found, "sky_view_factor"), expected,
                  estimator == Estimator::exact ? 0.003 : 0.006)
          << distance;
    }
  }
}

// A ceiling at height h counts (1 - h / (D cos)) of each direction: AO is 1 - (1 - h / D)^2.
TEST(PointTheory, AFalloffUnderACeilingIsItsIntegral) {
  const Scene scene = scene_of(square_mesh(1000, 1, 1, 0), 1);
  PointOptions options;
  options.rays = 4096;
  options.distance = 2;
  EXPECT_NEAR(mean_of(measure(scene, {V3f(0)}, options), "ao"), 1 - 0.75, 0.01) << "a cutoff";
  options.falloff = 1;
  const PointResult result = measure(scene, {V3f(0)}, options);
  EXPECT_NEAR(mean_of(result, "ao"), 0.75, 0.01);
  EXPECT_LT(mean_of(result, "sky_view_factor"), 0.01) << "without a distance";
  options.distance = 0;
  EXPECT_THROW(validate(options), Error);
}

TEST(PointTheory, GapFractionsOfTheRingsAreThoseOfARandomCanopy) {
  const Scene scene = canopy(2, 1);
  PointOptions options = periodic(Estimator::exact);
  options.sky_view_factor = options.ao = false;
  options.rings = 5;
  const PointResult found = measure(scene, ground_points(16), options);
  const double rings[5][2] = {{0, 13}, {16, 28}, {32, 43}, {47, 58}, {61, 74}};
  for (int k = 0; k < 5; ++k) {
    double expected = 0, weight = 0;  // the mean over the ring's solid angle
    for (double t = rings[k][0] + 0.05; t < rings[k][1]; t += 0.1) {
      expected += std::sin(t * kPi / 180) * std::exp(-1 / std::cos(t * kPi / 180));
      weight += std::sin(t * kPi / 180);
    }
    EXPECT_NEAR(mean_of(found, "gap_" + std::to_string(k + 1)), expected / weight, 0.02) << k;
  }
}

TEST(PointTheory, SkiesGiveTheirIrradianceOnAnOpenPlaneAndLessOnAWall) {
  Mesh far;
  append_grid(far, {0, -100, 0}, {0, 0, 0.1f}, {0.1f, 0, 0}, 1, 0);
  for (const bool overcast : {false, true}) {
    Scene scene = scene_of(far, 1);
    scene.lights = {overcast ? overcast_sky() : uniform_sky()};
    PointOptions options;
    options.ao = options.sky_view_factor = false;
    options.rays = 8192;
    const PointResult found = measure_points(scene, std::vector{V3f(0, 0, 0), V3f(0, 0, 0)},
                                             std::vector{V3f(0, 1, 0), V3f(1, 0, 0)}, options);
    for (const PointColumn& column : found.columns) {
      if (column.name != "sky_r") continue;
      EXPECT_NEAR(column.values.at(0), 1, 0.005);
      // Moon and Spencer: a vertical surface has (pi / 2 + 4 / 3) / 3 / (7 pi / 9).
      EXPECT_NEAR(column.values.at(1), overcast ? (kPi / 2 + 4.0 / 3) / 3 / (7 * kPi / 9) : 0.5,
                  0.005);
    }
  }
}

TEST(Points, AGroupIsTheSumOfItsLights) {
  Scene scene = canopy(0.5, 1);
  scene.lights.assign(3, uniform_sky());
  scene.lights[1].kind = LightKind::sun;
  scene.lights[1].direction = V3f(0.2f, -1, 0).normalized();
  scene.lights[1].radiance = V3f(2000, 1000, 500);
  scene.lights[1].angular_radius = 0.01f;
  scene.lights[2].name = "alone";
  scene.lights[0].group = scene.lights[1].group = "both";
  PointOptions options;
  options.ao = options.sky_view_factor = false;
  options.estimator = Estimator::exact;
  const std::vector<V3f> points(5, V3f(0, 0, 0)), normals(5, V3f(0, 1, 0));
  const PointResult together = measure_points(scene, points, normals, options);
  for (Light& light : scene.lights) light.group.clear();
  scene.lights[0].name = "a";
  scene.lights[1].name = "b";
  const PointResult apart = measure_points(scene, points, normals, options);
  const auto column = [](const PointResult& result, const std::string& name) {
    for (const PointColumn& each : result.columns)
      if (each.name == name) return each.values;
    ADD_FAILURE() << "no column " << name;
    return std::vector<float>(5);
  };
  for (const std::string channel : {"_r", "_g", "_b"}) {
    const auto sum = column(together, "both" + channel), a = column(apart, "a" + channel),
               b = column(apart, "b" + channel);
    EXPECT_EQ(column(together, "alone" + channel), column(apart, "alone" + channel));
    for (std::size_t i = 0; i < sum.size(); ++i) {
      EXPECT_NEAR(sum[i], a[i] + b[i], 1e-6 * sum[i]);
      EXPECT_GT(a[i], 0.1);
    }
  }
}

TEST(Points, WrongInputIsAnErrorAndNoPointsAreNoValues) {
  const Scene scene = canopy(0.01, 1);
  EXPECT_THROW(measure_points(scene, std::vector{V3f(0, 0, 0)}, {}), Error);
  EXPECT_THROW(measure_points(scene, std::vector{V3f(NAN, 0, 0)}, std::vector{V3f(0, 1, 0)}),
               Error);
  EXPECT_THROW(measure_points(scene, std::vector{V3f(0, 0, 0)}, std::vector{V3f(0, 2, 0)}), Error);
  PointOptions options;
  options.rays = 4;
  EXPECT_THROW(measure_points(scene, {}, {}, options), Error);
  EXPECT_TRUE(measure_points(scene, {}, {}).columns.at(0).values.empty());
}

}  // namespace
}  // namespace dapple
