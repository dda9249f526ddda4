// No popping: when a point or the camera moves slightly, prefiltered occlusion changes by hardly
// more than exact occlusion does. `dapple-bench accuracy --line` does the same at full size.
#include <gtest/gtest.h>

#include "support/scenes/line_of_points.hpp"
#include "support/scenes/receding_camera.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace popping;
using scene_test::SceneOnDevice;

constexpr float kFootprints[] = {0.5f, 1, 2, 4};

/// A change of occlusion, beyond that of exact, that nobody can see.
constexpr double kInvisible = 0.01;

/// How many standard errors of noise are added to that in pictures. About 80 steps are compared;
/// with normal errors, one beyond four would occur in one of 400 such tests.
constexpr double kNoise = 4;

/// 150 points, spaced as if 1000 of them went from side to side.
constexpr int kPoints = 150, kWholeLine = 1000;
constexpr Strata kStrata{64, 64};

/// Fails if a prefiltered step exceeds the exact one by more than kInvisible and `errors` standard
/// errors.
void expect_steady(const std::vector<Step>& found, const std::string& what, double errors) {
  const LargestSteps max = largest(found);
  std::printf("%s: largest step exact %.4f, prefiltered %.4f, beyond exact %+.4f (+- %.4f)\n",
              what.c_str(), max.exact, max.prefiltered, max.excess, max.error);
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_LE(found[i].excess(), kInvisible + errors * found[i].error)
        << what << ", step " << i << ": exact " << found[i].exact << ", prefiltered "
        << found[i].prefiltered;
  }
}

class Line {
 public:
  Line(const SceneOnDevice& scene, std::vector<Ray> rays)
      : scene_(scene),
        points_(line_through(scene.bvh.bounds, kPoints, kWholeLine)),
        rays_(std::move(rays)),
        exact_(traced(Estimator::exact, 0)) {}

  [[nodiscard]] std::vector<Step> steps_at(float footprint) const {
    return steps(exact_, traced(Estimator::prefiltered, footprint), rays_.size());
  }

  /// Every second point uses the footprint `other`, as if all nodes popped at once.
  [[nodiscard]] std::vector<Step> steps_between(float footprint, float other) const {
    std::vector<float> values = traced(Estimator::prefiltered, footprint);
    const std::vector<float> others = traced(Estimator::prefiltered, other);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i / rays_.size() % 2) values[i] = others[i];
    }
    return steps(exact_, values, rays_.size());
  }

 private:
  [[nodiscard]] std::vector<float> traced(Estimator estimator, float footprint) const {
    return transmittances(scene_test::device(), scene_.uploaded, points_, rays_, estimator,
                          footprint);
  }
  const SceneOnDevice& scene_;
  std::vector<V3f> points_;
  std::vector<Ray> rays_;
  std::vector<float> exact_;
};

void expect_steady_line(const char* name) {
  const SceneOnDevice scene(make_procedural(name));
  const Line hemisphere(scene, hemisphere_rays(kStrata, kStrata.count()));
  const Line sphere(scene, sphere_rays(kStrata, kStrata.count()));
  for (const float footprint : kFootprints) {
    const std::string at = std::string(name) + ", footprint " + std::to_string(footprint);
    expect_steady(hemisphere.steps_at(footprint), at + ", hemisphere", 0);
    expect_steady(sphere.steps_at(footprint), at + ", sphere", 0);
  }
  // Otherwise this test could not find popping.
  EXPECT_GT(largest(sphere.steps_between(1, 1 << 18)).excess, kInvisible) << name;
}

TEST(Popping, OcclusionAlongALineThroughATreeChangesLittleMoreThanExactDoes) {
  expect_steady_line("scene:tree");
}

TEST(Popping, OcclusionAlongALineThroughACloudChangesLittleMoreThanExactDoes) {
  expect_steady_line("scene:cloud");
}

// As the camera moves away, pixels and their footprints grow in the whole picture at once.
TEST(Popping, OcclusionOfATreeChangesLittleMoreThanExactDoesAsTheCameraIsPulledBack) {
  const SceneOnDevice scene(make_procedural("scene:tree"));
  const RecedingCamera path(scene.bvh.bounds, 20, 2);
  const FrameTracer tracer(scene_test::device(), scene.uploaded, scene.bvh.bounds, RenderOptions{},
                           32, 12);
  const std::vector<Frame> exact = tracer.frames(path, Estimator::exact, 0);
  const auto traced = [&](float footprint) {
    return tracer.frames(path, Estimator::prefiltered, footprint);
  };
  for (const float footprint : kFootprints)
    expect_steady(steps(exact, traced(footprint)), "camera, footprint " + std::to_string(footprint),
                  kNoise);
  // Far larger footprints in every second frame must be found; otherwise this test could not find
  // popping.
  std::vector<Frame> unsteady = traced(1);
  const std::vector<Frame> others = traced(65536);
  for (std::size_t i = 1; i < unsteady.size(); i += 2) unsteady[i] = others[i];
  const LargestSteps max = largest(steps(exact, unsteady));
  EXPECT_GT(max.excess, kInvisible);
}

}  // namespace
}  // namespace dapple
