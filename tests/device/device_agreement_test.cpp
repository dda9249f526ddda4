// All OpenCL devices must compute the same transmittance and closest hit for each ray. The command
// ./setup test-all has two devices, PoCL and Intel's runtime; with one device the test is skipped.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

// Compilers may contract and reorder additions. So a ray near the border of a box, of a triangle or
// of a footprint may hit on one device and miss on another: at most 2 rays in a thousand. All
// others agree to 1e-4, which is a few roundings of the fixed-point sums of optical depths.
constexpr double kOtherWay = 2e-3;
constexpr float kTolerance = 1e-4f;

struct Found {
  std::vector<Occlusion> occlusions;
  std::vector<SurfacePoint> points;
};

Found find(const std::string& name, const Scene& scene, const SceneBvh& bvh,
           const std::vector<Ray>& rays, Estimator estimator, Packets packets) {
  const Device device(name, "", packets);
  const DeviceScene uploaded = upload(device, scene, bvh);
  return {trace(device, uploaded, rays, estimator), closest_hits(device, uploaded, rays)};
}

void expect_the_same(const Found& a, const Found& b) {
  int transmittances = 0, distances = 0;
  double sum = 0;
  const std::size_t count = a.occlusions.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float difference = b.occlusions[i].transmittance - a.occlusions[i].transmittance;
    transmittances += std::fabs(difference) > kTolerance;
    sum += difference;
    const float t = a.points[i].t;
    distances += !(std::fabs(b.points[i].t - t) <= kTolerance * std::max(1.0f, std::fabs(t)));
  }
  EXPECT_LE(transmittances, kOtherWay * static_cast<double>(count));
  EXPECT_LE(distances, kOtherWay * static_cast<double>(count));
  EXPECT_LT(std::fabs(sum / static_cast<double>(count)), 1e-3);
}

TEST(DeviceAgreement, EachRayFindsTheSameOnEveryDevice) {
  const auto devices = list_devices();
  if (devices.size() < 2) {
    ASSERT_EQ(std::getenv("DAPPLE_TWO_DEVICES"), nullptr) << "there should be two";
    GTEST_SKIP() << "one OpenCL device, nothing to compare it with";
  }
  for (const char* name : {"scene:tree?leaves=2000", "scene:cloud?leaves=2000&opacity=0.2"}) {
    const Scene scene = make_procedural(name);
    const SceneBvh bvh = build_bvh(scene);
    const auto rays = rays_through(bvh.bounds, 5000, bvh.bounds.size().length(), 1e-3f, 5);
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      for (const Packets packets :
           {Packets::none, Packets::pixel, Packets::point, Packets::scalar}) {
        SCOPED_TRACE(testing::Message() << name << ", estimator " << static_cast<int>(estimator)
                                        << ", packets " << static_cast<int>(packets));
        const Found first = find(devices[0].name, scene, bvh, rays, estimator, packets);
        for (std::size_t d = 1; d < devices.size(); ++d) {
          SCOPED_TRACE(devices[0].name + " and " + devices[d].name);
          expect_the_same(first, find(devices[d].name, scene, bvh, rays, estimator, packets));
        }
      }
    }
  }
}

}  // namespace
}  // namespace dapple
