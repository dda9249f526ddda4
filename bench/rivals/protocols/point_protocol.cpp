#include "rivals/protocols/point_protocol.hpp"

#include <chrono>
#include <memory>

namespace dapple::bench {
namespace {

constexpr std::uint32_t kReferenceSeeds[2] = {0x7e000001u, 0x7e000002u};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Points in the form of dapple::occlusion(), which offsets the ray origins itself.
struct BakedPoints {
  std::vector<V3f> positions, normals;
};

Contestant by_embree(const RivalScene& scene, std::span<const Surface> points,
                     const EmbreeMethod& method) {
  const auto run = [&scene, points, method](double rays, std::uint32_t seed) {
    const auto start = std::chrono::steady_clock::now();
    Outcome outcome;
    outcome.values = embree_occlusion(scene.embree, method, points, static_cast<std::size_t>(rays),
                                      seed, kContestBlack);
    outcome.seconds = seconds_since(start);
    return outcome;
  };
  return {"Embree " + method.name(), true, true, {}, run};
}

Contestant by_dapple(const RivalScene& scene, const std::shared_ptr<BakedPoints>& points,
                     const char* name, Estimator estimator, float footprint) {
  const auto run = [&scene, points, estimator, footprint](double rays, std::uint32_t seed) {
    OcclusionOptions options;
    options.rays = static_cast<int>(rays);
    options.estimator = estimator;
    options.footprint = footprint;
    options.seed = seed;
    const auto start = std::chrono::steady_clock::now();
    const std::vector<float> ao =
        occlusion(scene.device, scene.on_device, points->positions, points->normals, options);
    return Outcome{seconds_since(start), {ao.begin(), ao.end()}};
  };
  return {name, false, estimator == Estimator::exact, {}, run};
}

}  // namespace

Truth point_truth(const RivalScene& scene, std::span<const Surface> points, std::size_t rays) {
  const auto half = [&](std::uint32_t seed) {
    return embree_occlusion(scene.embree, {Alpha::multiplicative, 1, false, false}, points,
                            (rays + 1) / 2, seed, kReferenceBlack);
  };
  return truth_of_halves(half(kReferenceSeeds[0]), half(kReferenceSeeds[1]));
}

std::vector<Contestant> point_contestants(const RivalScene& scene, std::span<const Surface> points,
                                          const std::vector<EmbreeMethod>& methods,
                                          const PointQueries& queries) {
  auto baked = std::make_shared<BakedPoints>();
  for (const Surface& point : points) {
    baked->positions.push_back(point.position);
    baked->normals.push_back(point.normal);
  }
  std::vector<Contestant> contestants;
  for (const EmbreeMethod& method : methods)
    contestants.push_back(by_embree(scene, points, method));
  contestants.push_back(by_dapple(scene, baked, "exact", Estimator::exact, queries.footprint));
  contestants.push_back(
      by_dapple(scene, baked, "prefiltered", Estimator::prefiltered, queries.footprint));
  for (Contestant& contestant : contestants)
    for (std::size_t rays = 1; rays <= queries.max_rays; rays *= 2)
      contestant.ladder.push_back(static_cast<double>(rays));
  return contestants;
}

}  // namespace dapple::bench
