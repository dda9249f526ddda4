// Nothing pops: when a point or the camera moves by a little, prefiltered occlusion changes by
// hardly more than exact occlusion does. dapple-bench accuracy --line does the same at full
// size.
#include <gtest/gtest.h>

#include "line_of_points.hpp"
#include "pulled_back_camera.hpp"
#include "scene_on_device.hpp"

namespace dapple {
namespace {

using namespace popping;
using scene_test::SceneOnDevice;

constexpr float kFootprints[] = {0.5f, 1, 2, 4};

/// What nobody sees, beyond the change that exact shows.
constexpr double kInvisible = 0.01;

/// Standard errors by which noise may add to that. Some 5,000 steps are compared: of normal
/// errors one beyond five would turn up in one of 700 such tests.
constexpr double kNoise = 5;

/// Points have the spacing of a thousand from side to side; there are fewer rays a point, but
/// their footprints are those of 4,096.
constexpr int kPoints = 300, kWholeLine = 1000, kShared = 4096;
constexpr Strata kStrata{32, 16};

void expect_steady(const std::vector<Step>& found, const std::string& what) {
  const LargestSteps most = largest(found);
  std::printf("%s: largest step exact %.4f, prefiltered %.4f, beyond exact %+.4f (+- %.4f)\n",
              what.c_str(), most.exact, most.prefiltered, most.excess, most.error);
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_LE(found[i].excess(), kInvisible + kNoise * found[i].error)
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
  const Line hemisphere(scene, hemisphere_rays(kStrata, kShared));
  const Line sphere(scene, sphere_rays(kStrata, kShared));
  for (const float footprint : kFootprints) {
    const std::string at = std::string(name) + ", footprint " + std::to_string(footprint);
    expect_steady(hemisphere.steps_at(footprint), at + ", hemisphere");
    expect_steady(sphere.steps_at(footprint), at + ", sphere");
  }
  // The measure can see popping: with footprints of whole boughs everything jumps as the point
  // goes from box to box.
  EXPECT_GT(largest(sphere.steps_at(4096)).excess, 5 * kInvisible) << name;
}

TEST(Popping, OcclusionAlongALineThroughATreeChangesLittleMoreThanExactDoes) {
  expect_steady_line("scene:tree");
}

TEST(Popping, OcclusionAlongALineThroughACloudChangesLittleMoreThanExactDoes) {
  expect_steady_line("scene:cloud");
}

// Wider pixels make wider footprints, at every point of the picture at once.
TEST(Popping, OcclusionOfATreeChangesLittleMoreThanExactDoesAsTheCameraIsPulledBack) {
  const SceneOnDevice scene(make_procedural("scene:tree"));
  const PulledBackCamera path(scene.bvh.bounds, 20);
  const FrameTracer tracer(scene_test::device(), scene.uploaded, scene.bvh.bounds, RenderOptions{},
                           32, 4);
  const std::vector<Frame> exact = tracer.frames(path, Estimator::exact, 0);
  const auto steps_at = [&](float footprint) {
    return steps(exact, tracer.frames(path, Estimator::prefiltered, footprint));
  };
  for (const float footprint : kFootprints)
    expect_steady(steps_at(footprint), "camera, footprint " + std::to_string(footprint));
}

}  // namespace
}  // namespace dapple
