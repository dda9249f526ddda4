// Many suns of which each ray stands for some: how often each is chosen, footprints, values and
// their standard errors against a ray to every sun.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "dapple/points.hpp"
#include "points/point_sets.hpp"
#include "points/sun_rays.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using Imath::V3d;

const V3f kUp(0, 1, 0);

/// Directions that fill a cap of the sphere around +Y evenly.
std::vector<SunDirection> cap(int count, double cos_half_angle) {
  std::vector<SunDirection> suns;
  for (int i = 0; i < count; ++i) {
    const double y = 1 - (1 - cos_half_angle) * (i + 0.5) / count, r = std::sqrt(1 - y * y);
    const double around = 2.399963 * i;
    suns.push_back({V3f(static_cast<float>(r * std::cos(around)), static_cast<float>(y),
                        static_cast<float>(r * std::sin(around))),
                    static_cast<float>(1 + i % 3)});
  }
  return suns;
}

std::vector<Ray> sampled(const SunRays& suns, const V3f& normal, std::size_t count,
                         std::size_t sets, std::uint32_t random) {
  std::vector<Ray> rays(count);
  suns.sample(V3f(0, 0, 0), normal, sets, random, rays);
  return rays;
}

V3f direction_of(const Ray& ray) {
  return V3f(ray.direction[0], ray.direction[1], ray.direction[2]);
}

V3f nearest(const std::vector<SunDirection>& suns, const Ray& ray) {
  const V3f to = direction_of(ray);
  return std::max_element(suns.begin(), suns.end(),
                          [&](const SunDirection& a, const SunDirection& b) {
                            return a.direction.dot(to) < b.direction.dot(to);
                          })
      ->direction;
}

// Of a cap of angle a the cosines to its middle are even from cos a to 1.
TEST(SunRays, FillTheDiskOfASunEvenly) {
  const double down = 1 - std::cos(0.533 / 2 * std::numbers::pi / 180);
  for (const V3f& middle : {V3f(0, 1, 0), V3f(0.6f, 0, -0.8f), V3f(1, 0, 0)}) {
    const SunRays rays(std::vector<SunDirection>{{middle, 1}});
    constexpr int kParts = 4;
    int in_part[kParts] = {};
    V3d sum(0, 0, 0);
    const std::vector<Ray> found = sampled(rays, middle, 1024, 8, 77);
    for (const Ray& ray : found) {
      const V3d to(direction_of(ray));
      EXPECT_NEAR(to.length(), 1, 1e-6);
      const double at = (to - V3d(middle)).length2() / 2 / down;  // 1 - cosine
      ASSERT_LT(at, 1.01);
      ++in_part[std::min(kParts - 1, static_cast<int>(at * kParts))];
      sum += to - V3d(middle);
    }
    for (const int count : in_part) EXPECT_NEAR(count, 1024 / kParts, 12);
    EXPECT_LT((sum / 1024).length(), 0.02 * std::sqrt(2 * down)) << "to all sides";
  }
}

TEST(SunRays, ChooseEachSunAsOftenAsItBringsIrradiance) {
  const std::vector<SunDirection> suns = cap(60, 0.1);
  const SunRays rays(suns);
  const V3f normal = V3f(1, 1, 0.3f).normalized();
  constexpr int kRepeats = 4000, kRays = 16;
  std::map<std::array<float, 3>, int> chosen;
  for (std::uint32_t repeat = 0; repeat < kRepeats; ++repeat)
    for (const Ray& ray : sampled(rays, normal, kRays, 4, repeat * 2654435769u)) {
      const V3f sun = nearest(suns, ray);
      ++chosen[{sun.x, sun.y, sun.z}];
    }
  for (const SunDirection& sun : suns) {
    const double share =
        std::max(0.0, double{sun.irradiance * normal.dot(sun.direction)}) / rays.unoccluded(normal);
    const double expected = share * kRepeats * kRays;
    const int found = chosen[{sun.direction.x, sun.direction.y, sun.direction.z}];
    EXPECT_NEAR(found, expected, 5 * std::sqrt(expected)) << sun.direction;
  }
}

TEST(SunRays, EachSetTakesOneRayOfEachStratum) {
  // Two groups of suns of the same irradiance, far apart on the curve.
  std::vector<SunDirection> suns(100, {V3f(0.6f, 0.8f, 0), 1});
  suns.resize(200, {V3f(-0.6f, 0.8f, 0), 1});
  const SunRays rays(suns);
  for (std::uint32_t random = 0; random < 50; ++random) {
    const std::vector<Ray> found = sampled(rays, kUp, 64, 8, random * 77);
    int right[8] = {};
    for (std::size_t r = 0; r < found.size(); ++r) right[r % 8] += found[r].direction[0] > 0;
    for (const int in_set : right) EXPECT_EQ(in_set, 4);
  }
}

TEST(SunRays, AFootprintIsTheCapOverWhichTheSunsOfAStratumSpread) {
  constexpr double kCosine = 0.9;
  const double solid_angle = 2 * std::numbers::pi * (1 - kCosine);
  const SunRays suns(cap(3000, kCosine));
  EXPECT_NEAR(double{sampled(suns, kUp, 1, 1, 5)[0].solid_angle}, solid_angle, 0.01 * solid_angle);
  // Strata of an evenly filled cap have their share of it, or more: on the curve they are not
  // round.
  double sum = 0;
  for (const Ray& ray : sampled(suns, kUp, 64, 1, 5)) sum += double{ray.solid_angle};
  EXPECT_GT(sum, solid_angle);
  EXPECT_LT(sum, 2 * solid_angle);
  const SunRays one(std::vector<SunDirection>(10, {V3f(0, 1, 0), 1}));
  EXPECT_EQ(sampled(one, kUp, 4, 2, 0)[3].solid_angle, kSunSolidAngle);
}

TEST(SunRays, EndAtOnceWhereNoSunShines) {
  const SunRays suns(cap(300, 0.5));
  EXPECT_EQ(suns.unoccluded(V3f(0, -1, 0)), 0);
  for (const Ray& ray : sampled(suns, V3f(0, -1, 0), 16, 8, 3)) EXPECT_EQ(ray.t_max, 0);
  for (const Ray& ray : sampled(suns, kUp, 16, 8, 3)) EXPECT_GT(ray.t_max, 1e30f);
}

const PointColumn& column(const PointResult& result, const std::string& name) {
  for (const PointColumn& one : result.columns)
    if (one.name == name) return one;
  throw std::runtime_error("no column " + name);
}

PointResult under_tree(const PointOptions& options) {
  std::vector<V3f> points;
  for (int i = 0; i < 400; ++i)
    points.emplace_back(0.3f * static_cast<float>(i % 20) - 3, 0.01f,
                        0.3f * static_cast<float>(i / 20) - 3);
  const std::vector<V3f> normals(points.size(), kUp);
  return measure_points(make_procedural("scene:tree?leaves=20000&opacity=1"), points, normals,
                        options);
}

TEST(SunSampling, SumsAgreeWithARayToEachSunWithinTheirErrors) {
  PointOptions options;
  options.ao = options.sky_view_factor = false;
  options.suns = cap(2000, 0.2);
  options.estimator = Estimator::exact;
  options.per_sun = true;
  const PointResult each = under_tree(options);
  EXPECT_TRUE(each.notes.empty());
  ASSERT_EQ(each.columns.size(), options.suns.size());
  std::vector<double> truth(each.columns[0].values.size());
  for (const PointColumn& of_sun : each.columns)
    for (std::size_t i = 0; i < truth.size(); ++i) truth[i] += double{of_sun.values[i]};
  options.per_sun = false;
  double whole = 0;
  for (const SunDirection& sun : options.suns) whole += double{sun.irradiance * sun.direction.y};
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    options.estimator = estimator;
    const PointResult some = under_tree(options);
    const std::vector<float>&values = column(some, "sun").values,
          &errors = column(some, "sun_error").values;
    double mean = 0, squares = 0, said = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const double difference = (double{values[i]} - truth[i]) / whole;
      mean += difference / 400;
      squares += difference * difference / 400;
      said += std::pow(double{errors[i]} / whole, 2) / 400;
    }
    std::printf("relative mean %+.4f, RMSE %.4f, standard error %.4f\n", mean, std::sqrt(squares),
                std::sqrt(said));
    EXPECT_NEAR(mean, 0, 0.003);
    EXPECT_LT(std::sqrt(squares), 1.2 * std::sqrt(said));
    EXPECT_LT(std::sqrt(said), 0.02);
    EXPECT_GT(std::sqrt(said), 0.001);
    EXPECT_EQ(some.bias.count("sun"), estimator == Estimator::exact ? 0u : 1u);
  }
}

TEST(SunSampling, TheSameSeedGivesTheSameBitsAndAnotherOthers) {
  PointOptions options;
  options.ao = options.sky_view_factor = false;
  options.suns = cap(100, 0.2);
  options.rays = 64;
  const std::vector<float> first = column(under_tree(options), "sun").values;
  EXPECT_EQ(column(under_tree(options), "sun").values, first);
  options.seed = 1;
  EXPECT_NE(column(under_tree(options), "sun").values, first);
  options.per_sun = true;
  EXPECT_EQ(under_tree(options).columns.size(), 100u) << "each sun has its ray";
}

// An edge 1 m above hides a part of the sun's disk, of radius r = tan(0.2665 degrees): of the disk
// (acos(t) - t sqrt(1 - t^2)) / pi is seen where t r is the distance into the shadow.
TEST(SunSampling, StandardErrorsInPenumbrasAreThoseOfTheValues) {
  scene_test::Points random(4);
  Scene scene;
  scene.materials.push_back(scene_test::material_of(1));
  Mesh half_plane;
  scene_test::append_grid(half_plane, {-50, 1, 50}, {50, 0, 0}, {0, 0, -100}, 4, 0);
  scene_test::place(scene, std::move(half_plane));
  const double radius = std::tan(0.2665 * std::numbers::pi / 180);
  std::vector<V3f> points;
  std::vector<double> expected;
  for (int i = 0; i < 500; ++i) {
    const double t = 1.8 * random.unit() - 0.9;
    points.emplace_back(static_cast<float>(-t * radius), 0.0f, 4 * random.unit());
    expected.push_back(200 * (std::acos(t) - t * std::sqrt(1 - t * t)) / std::numbers::pi);
  }
  PointOptions options;
  options.ao = options.sky_view_factor = false;
  options.rays = 256;
  options.estimator = Estimator::exact;
  options.suns = {{kUp, 200}};
  const PointResult found =
      measure_points(scene, points, std::vector<V3f>(points.size(), kUp), options);
  ASSERT_EQ(found.columns.size(), 2u);
  double squares = 0, told = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    squares += std::pow(found.columns[0].values[i] - expected[i], 2);
    told += std::pow(found.columns[1].values[i], 2);
  }
  const double ratio = std::sqrt(told / squares);
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.8) << "told " << std::sqrt(told / 500) << ", is " << std::sqrt(squares / 500);
}

// Whose product with the number of sets would not fit 32 bits.
TEST(SunSampling, LargeSeedsAreOtherSeeds) {
  std::set<std::uint32_t> seeds;
  PointOptions options;
  for (const std::uint32_t seed : {0u, 1u, 1u << 29, 1u << 30, (1u << 29) + 1, 0xffffffffu}) {
    options.seed = seed;
    for (int set = 0; set < kPointSets; ++set) seeds.insert(rays_of_set(options, set).seed);
  }
  EXPECT_EQ(seeds.size(), 6u * kPointSets);
}

}  // namespace
}  // namespace dapple
