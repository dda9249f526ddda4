// Russian roulette of exact rays: which rays it changes, what they count as, and that the mean
// stays.
#include <gtest/gtest.h>

#include <cmath>

#include "device/context.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/queues.hpp"
#include "support/scenes/traced_scenes.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr float kLeast = 0.6f;
constexpr std::size_t kRaysOfPoint = 64;

/// Scenes in which many rays keep some transmittance below kLeast.
std::vector<Scene> veiled_scenes() {
  std::vector<Scene> scenes;
  scenes.push_back(make_procedural("scene:cloud?leaves=20000&opacity=0.3"));
  scenes.push_back(make_procedural("scene:tree?leaves=2000&opacity=0.7"));
  scenes.push_back(forest_scaled_non_uniformly());
  scenes.push_back(textured_cards());
  scenes.push_back(make_procedural("scene:hair?strands=2000"));
  return scenes;
}

/// Rays from the middle of the scene, kRaysOfPoint and more from each origin, with random keys.
std::vector<Ray> rays_of_points(const Box3f& bounds) {
  const float size = bounds.size().length();
  std::vector<Ray> rays = rays_through(bounds, 128 * kRaysOfPoint, size, 1e-3f, 5);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const V3f origin =
        bounds.center() + bounds.size() * (0.01f * static_cast<float>(i / 512) - 0.08f);
    for (int axis = 0; axis < 3; ++axis) rays[i].origin[axis] = origin[axis];
    rays[i].key = static_cast<std::uint32_t>(i) * 0x9e3779b9u;
  }
  return rays;
}

std::vector<Occlusion> traced(const SceneOnDevice& scene, const std::vector<Ray>& rays,
                              Packets with, Estimator estimator, float roulette) {
  DeviceContext& context = device().context();
  const Queues queues = make_queues(context, rays.size(), 1);
  context.write(queues.rays, rays.data(), rays.size() * sizeof(Ray));
  OcclusionParams params{};
  params.scene = scene.uploaded.buffers->params;
  params.ray_count = static_cast<uint>(rays.size());
  params.rays_per_point = kRaysOfPoint;
  params.footprint = 1;
  params.roulette = roulette;
  occlusion_pass_with(with, context, queues, *scene.uploaded.buffers, "test", estimator, params);
  std::vector<Occlusion> found(rays.size());
  context.read(queues.occlusions, found.data(), found.size() * sizeof(Occlusion));
  return found;
}

constexpr Packets kAllKinds[] = {Packets::none, Packets::pixel, Packets::point, Packets::scalar};

TEST(Roulette, KeepsTheMeanOfRaysThatItChangesAndLeavesAllOthers) {
  for (const Scene& made : veiled_scenes()) {
    const SceneOnDevice scene(made);
    const std::vector<Ray> rays = rays_of_points(scene.bvh.bounds);
    for (const Packets with : kAllKinds) {
      SCOPED_TRACE(made.source + ", " + name_of(with));
      const auto whole = traced(scene, rays, with, Estimator::exact, 0);
      const auto ended = traced(scene, rays, with, Estimator::exact, kLeast);
      double difference = 0, variance = 0;
      int below = 0, odd = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const double all = whole[i].transmittance, kept = ended[i].transmittance;
        if (all > kLeast || all == 0) {
          EXPECT_FLOAT_EQ(ended[i].transmittance, whole[i].transmittance);
          continue;
        }
        ++below;
        odd += kept != 0 && std::fabs(kept - kLeast) > 1e-6;
        difference += kept - all;
        variance += all * (kLeast - all);
      }
      EXPECT_GT(below, 300);
      EXPECT_EQ(odd, 0);
      EXPECT_LT(std::fabs(difference), 4 * std::sqrt(variance));
    }
  }
}

TEST(Roulette, EndsTheSameRaysInAllKindsOfPackets) {
  for (const Scene& made : veiled_scenes()) {
    const SceneOnDevice scene(made);
    const std::vector<Ray> rays = rays_of_points(scene.bvh.bounds);
    const auto single = traced(scene, rays, Packets::none, Estimator::exact, kLeast);
    for (const Packets with : {Packets::pixel, Packets::point, Packets::scalar}) {
      const auto other = traced(scene, rays, with, Estimator::exact, kLeast);
      int different = 0;
      for (std::size_t i = 0; i < rays.size(); ++i)
        different += std::fabs(other[i].transmittance - single[i].transmittance) > 1e-4f;
      // Kernels round differently, as in scalar_test.cpp.
      EXPECT_LT(different, 2e-3 * static_cast<double>(rays.size()))
          << made.source << ", " << name_of(with);
    }
  }
}

TEST(Roulette, SavesTestsOfTrianglesAndChangesNoPrefilteredRay) {
  const SceneOnDevice scene(make_procedural("scene:tree?leaves=20000&opacity=0.85"));
  const std::vector<Ray> rays = rays_of_points(scene.bvh.bounds);
  for (const Packets with : kAllKinds) {
    SCOPED_TRACE(name_of(with));
    double tests[2] = {};
    for (const bool ends : {false, true}) {
      for (const Occlusion& found :
           traced(scene, rays, with, Estimator::exact, ends ? kLeast : 0.0f))
        tests[ends] += found.visits >> 16;
    }
    std::printf("%s: triangle tests with roulette over those without: %.3f\n",
                name_of(with).c_str(), tests[1] / tests[0]);
    EXPECT_LT(tests[1], 0.9 * tests[0]);
    const auto whole = traced(scene, rays, with, Estimator::prefiltered, 0);
    const auto ended = traced(scene, rays, with, Estimator::prefiltered, kLeast);
    for (std::size_t i = 0; i < rays.size(); ++i)
      EXPECT_EQ(whole[i].transmittance, ended[i].transmittance);
  }
}

TEST(Roulette, OfAPictureKeepsItsMeans) {
  const Scene scene = make_procedural("scene:tree?leaves=5000&opacity=0.85");
  RenderOptions options;
  options.width = options.height = 48;
  options.spp = 32;
  options.estimator = Estimator::exact;
  options.roulette = 0;
  const Film whole = render(scene, options).film;
  options.roulette = 0.5f;
  const Film ended = render(scene, options).film;
  for (const Plane& plane : whole.planes) {
    const Plane* other = ended.find(plane.channel);
    ASSERT_NE(other, nullptr);
    double difference = 0, squares = 0;
    for (std::size_t i = 0; i < plane.pixels.size(); ++i) {
      const double apart = other->pixels[i] - plane.pixels[i];
      difference += apart;
      squares += apart * apart;
    }
    if (plane.channel == "ao.R" || plane.channel.starts_with("light.")) {
      EXPECT_GT(squares, 0) << plane.channel;
      EXPECT_LE(std::fabs(difference), 4 * std::sqrt(squares)) << plane.channel;
    }
    if (plane.channel == "A" || plane.channel == "albedo.R") {
      EXPECT_EQ(squares, 0) << plane.channel;
    }
  }
}

}  // namespace
}  // namespace dapple
