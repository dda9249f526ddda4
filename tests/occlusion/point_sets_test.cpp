// AO at points, as a baker requests it. Each point has its own set of ray directions, made for that
// number of rays; the set does not depend on the other points of the call.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "sampling/point_order.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

struct Ground {
  std::vector<V3f> points, normals;
};

Ground ground_below_a_tree(int count) {
  Ground ground;
  Points points(3);
  for (int i = 0; i < count; ++i) {
    ground.points.emplace_back(4 * points.unit() - 2, 0.0f, 4 * points.unit() - 2);
    ground.normals.emplace_back(0.0f, 1.0f, 0.0f);
  }
  return ground;
}

std::vector<float> occlusion_of(const SceneOnDevice& scene, const Ground& ground, int rays,
                                std::uint32_t seed, Estimator estimator) {
  OcclusionOptions options;
  options.rays = rays;
  options.seed = seed;
  options.estimator = estimator;
  return occlusion(device(), scene.uploaded, ground.points, ground.normals, options);
}

/// Standard deviation of a point's occlusion between seeds, rms over the points.
double noise(const SceneOnDevice& scene, const Ground& ground, int rays, Estimator estimator) {
  constexpr int kSeeds = 8;
  std::vector<double> sums(ground.points.size()), squares(ground.points.size());
  for (std::uint32_t seed = 2; seed < 2 + kSeeds; ++seed) {
    const auto found = occlusion_of(scene, ground, rays, seed, estimator);
    for (std::size_t i = 0; i < found.size(); ++i) {
      sums[i] += found[i];
      squares[i] += double{found[i]} * found[i];
    }
  }
  double variance = 0;
  for (std::size_t i = 0; i < sums.size(); ++i)
    variance += (squares[i] - sums[i] * sums[i] / kSeeds) / (kSeeds - 1);
  return std::sqrt(variance / static_cast<double>(sums.size()));
}

struct NoiseCase {
  int rays;
  Estimator estimator;
  double net;  ///< noise of Owen-scrambled (0,2)-nets in the concentric map, with the same seeds
};

TEST(PointSets, AreLessNoisyThanNets) {
  const SceneOnDevice scene(make_procedural("scene:tree?leaves=2000"));
  const Ground ground = ground_below_a_tree(400);
  for (const NoiseCase& c : {NoiseCase{12, Estimator::exact, 0.0821},
                             {16, Estimator::exact, 0.0673},
                             {12, Estimator::prefiltered, 0.0409},
                             {16, Estimator::prefiltered, 0.0297},
                             {64, Estimator::prefiltered, 0.0123}}) {
    const double found = noise(scene, ground, c.rays, c.estimator);
    std::printf("%d rays: %.4f, of nets %.4f\n", c.rays, found, c.net);
    // Smooth integrands gain most.
    EXPECT_LT(found, (c.estimator == Estimator::exact ? 0.97 : 0.8) * c.net) << c.rays << " rays";
  }
}

TEST(PointSets, AreUnbiased) {
  const SceneOnDevice scene(make_procedural("scene:tree?leaves=2000"));
  const Ground ground = ground_below_a_tree(400);
  const auto mean = [](const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  const double truth = mean(occlusion_of(scene, ground, 1 << 14, 1, Estimator::exact));
  for (const int rays : {1, 2, 5, 16}) {
    double sum = 0, squares = 0;
    constexpr int kSeeds = 40;
    for (std::uint32_t seed = 2; seed < 2 + kSeeds; ++seed) {
      const double found = mean(occlusion_of(scene, ground, rays, seed, Estimator::exact));
      sum += found;
      squares += found * found;
    }
    const double average = sum / kSeeds, variance = squares / kSeeds - average * average;
    EXPECT_NEAR(average, truth, 4 * std::sqrt(variance / kSeeds) + 1e-4) << rays << " rays";
  }
}

TEST(PointSets, RaysOfAPointDoNotDependOnOtherPoints) {
  const SceneOnDevice scene(make_procedural("scene:tree?leaves=2000"));
  Ground ground = ground_below_a_tree(300);
  for (const int rays : {4, 24}) {
    const auto together = occlusion_of(scene, ground, rays, 7, Estimator::prefiltered);
    // Points with odd indices stay; the others move.
    Ground moved = ground;
    for (std::size_t i = 0; i < moved.points.size(); i += 2) moved.points[i].y = 3;
    const auto apart = occlusion_of(scene, moved, rays, 7, Estimator::prefiltered);
    for (std::size_t i = 1; i < together.size(); i += 2)
      ASSERT_EQ(together[i], apart[i]) << "point " << i << ", " << rays << " rays";
  }
}

/// Compares points whose rays are made, traced and summed by one kernel (point packets) with points
/// whose rays are written to queues and traced as single rays.
class PointAo : public testing::Test {
 protected:
  using Found = std::pair<std::vector<float>, std::vector<float>>;
  Found found(const OcclusionOptions& options) const {
    return {occlusion(at_once_, on_at_once_, ground_.points, ground_.normals, options),
            occlusion(alone_, on_alone_, ground_.points, ground_.normals, options)};
  }
  static OcclusionOptions options(int rays, Estimator estimator, float distance) {
    return {rays, estimator, 1.0f, distance, distance > 0 ? 2.0f : 0.0f, 11};
  }

 private:
  const Scene scene_ = make_procedural("scene:forest?trees=20&leaves=500");
  const SceneBvh bvh_ = build_bvh(scene_);
  const Device at_once_{"", "", Packets::point}, alone_{"", "", Packets::none};
  const DeviceScene on_at_once_ = upload(at_once_, scene_, bvh_);
  const DeviceScene on_alone_ = upload(alone_, scene_, bvh_);
  const Ground ground_ = ground_below_a_tree(60);
};

TEST_F(PointAo, ExactOcclusionAgreesWithQueues) {
  for (const int rays : {5, 32, 63, 100, 512}) {
    for (const float distance : {0.0f, 6.0f}) {
      SCOPED_TRACE(std::to_string(rays) + " rays, distance " + std::to_string(distance));
      const auto [at_once, in_passes] = found(options(rays, Estimator::exact, distance));
      int apart = 0;
      for (std::size_t i = 0; i < at_once.size(); ++i) {
        EXPECT_NEAR(at_once[i], in_passes[i], 1.5 / rays) << "point " << i;
        apart += std::fabs(at_once[i] - in_passes[i]) > 1e-4f ? 1 : 0;
      }
      // A ray within rounding of an edge may pass it on either side.
      EXPECT_LE(apart, 3);
      EXPECT_LT(*std::min_element(at_once.begin(), at_once.end()), 0.97f) << "nothing to see";
    }
  }
}

/// Point packets take a node's optical depth along the direction to its middle, single rays along
/// each ray.
TEST_F(PointAo, PrefilteredOcclusionIsNearThatOfQueues) {
  for (const int rays : {16, 100}) {
    for (const float distance : {0.0f, 6.0f}) {
      SCOPED_TRACE(std::to_string(rays) + " rays, distance " + std::to_string(distance));
      const auto [at_once, in_passes] = found(options(rays, Estimator::prefiltered, distance));
      double sum = 0, squares = 0;
      for (std::size_t i = 0; i < at_once.size(); ++i) {
        const double apart = double{at_once[i]} - in_passes[i];
        sum += apart;
        squares += apart * apart;
      }
      const auto count = static_cast<double>(at_once.size());
      EXPECT_LT(std::fabs(sum / count), 0.002);
      EXPECT_LT(std::sqrt(squares / count), 0.005);
      EXPECT_GT(squares, 0) << "the same kernel";
    }
  }
}

TEST(PointSets, AoIsOneWithoutOccluders) {
  const SceneOnDevice scene(make_procedural("scene:tree?leaves=2000"));
  const V3f below(0, -1, 0);
  for (const int rays : {1, 16, 100, 512, 1000}) {
    OcclusionOptions options;
    options.rays = rays;
    EXPECT_EQ(scene.occlusion_at(V3f(0, -1, 0), below, options), 1.0f) << rays << " rays";
  }
}

TEST(PointOrder, ListsEveryPointOnceAndKeepsNeighboursTogether) {
  Points random(9);
  std::vector<V3f> points;
  for (int i = 0; i < 5000; ++i) points.push_back(random.in_cube(10));
  points.push_back(points[7]);
  points.emplace_back(std::nanf(""), 0.0f, 0.0f);
  points.emplace_back(0.0f, INFINITY, 0.0f);
  std::vector<std::uint32_t> order = order_along_curve({points.data(), 5001});
  double ways = 0, unsorted = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    ways += (points[order[i]] - points[order[i - 1]]).length();
    unsorted += (points[i] - points[i - 1]).length();
  }
  EXPECT_LT(ways, 0.15 * unsorted);
  const auto seventh = std::find(order.begin(), order.end(), 7u);
  ASSERT_NE(seventh, order.end());
  EXPECT_EQ(*(seventh + 1), 5000u);  // a copy of point 7
  order = order_along_curve(points);
  std::sort(order.begin(), order.end());
  for (std::uint32_t i = 0; i < points.size(); ++i) ASSERT_EQ(order[i], i);
  EXPECT_TRUE(order_along_curve({}).empty());
}

}  // namespace
}  // namespace dapple
