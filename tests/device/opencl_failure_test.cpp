// OpenCL calls and allocations that fail, one after the other: each failure gives one Error, leaves
// no OpenCL object allocated, and the next picture is right.
#include <gtest/gtest.h>

#include <algorithm>

#include "dapple/error.hpp"
#include "support/failing_opencl.hpp"
#include "support/files/film_files.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace opencl_test;

RenderOptions small_picture() {
  RenderOptions options;
  options.width = options.height = 8;
  options.spp = 1;
  return options;
}

std::vector<std::uint32_t> render_small() {
  const RenderResult result = render(make_procedural("scene:cube?divisions=1"), small_picture());
  std::vector<std::uint32_t> bits;
  for (const Plane& plane : result.film.planes) {
    const auto of_plane = film_test::bits_of(plane.pixels);
    bits.insert(bits.end(), of_plane.begin(), of_plane.end());
  }
  return bits;
}

bool loads_kernels(const std::string& call) {
  const std::string calls[] = {"clCreateProgramWithSource", "clBuildProgram", "clCreateKernel"};
  return std::find(std::begin(calls), std::end(calls), call) != std::end(calls);
}

class OpenclFailure : public testing::Test {
 protected:
  OpenclFailure() : picture_(render_small()), living_before_(living_objects()) {}
  ~OpenclFailure() override { fail_call(0); }

  /// Renders after fail_call(n) or fail_allocation(n), and expects one Error. Kernels are loaded
  /// ahead on another thread: if a call of theirs fails there, it is made again, and the picture is
  /// right.
  void expect_one_error(int n) {
    SCOPED_TRACE("failure " + std::to_string(n));
    std::string what;
    try {
      EXPECT_TRUE(render_small() == picture_) << failed_call();
      if (failed_call() == "clGetDeviceInfo") {
        EXPECT_EQ(++untold_, 1) << "drivers may keep silent on whose memory a device has, alone";
      } else {
        EXPECT_TRUE(loads_kernels(failed_call())) << failed_call() << ": no Error was thrown";
      }
    } catch (const Error& error) {
      what = error.what();
      EXPECT_EQ(error.kind(), ErrorKind::device) << failed_call();
      EXPECT_NE(what, "");
    }
    EXPECT_NE(failed_call(), "");
    EXPECT_EQ(living_objects(), living_before_) << failed_call() << ": " << what;
  }
  void expect_the_same_picture() const {
    fail_call(0);
    EXPECT_TRUE(render_small() == picture_);
  }

  const std::vector<std::uint32_t> picture_;
  const int living_before_;
  int untold_ = 0;  ///< questions about the device whose failure was no error
};

class OpenclFailureAtEveryCall : public OpenclFailure {};

TEST_F(OpenclFailureAtEveryCall, IsOneErrorAndLeaksNothing) {
  fail_call(0);
  expect_the_same_picture();
  const int count = calls();
  EXPECT_GT(count, 100);
  // Leaves out the last call: in a destructor it waits for a queue that is already idle.
  for (int n = 1; n < count; ++n) {
    fail_call(n);
    expect_one_error(n);
  }
  expect_the_same_picture();
}

TEST_F(OpenclFailure, AtEveryAllocationIsOneErrorAndLeaksNothing) {
  fail_allocation(0);
  expect_the_same_picture();
  const int count = allocations();
  EXPECT_GT(count, 10);
  for (int n = 1; n <= count; ++n) {
    fail_allocation(n);
    expect_one_error(n);
  }
  expect_the_same_picture();
}

TEST_F(OpenclFailure, LeavesTheDeviceUsable) {
  const scene_test::SceneOnDevice scene(make_procedural("scene:cube?divisions=1"));
  const auto rays = scene_test::rays_through(scene.bvh.bounds, 100, 5, 0, 1);
  const auto before = scene.trace(rays, Estimator::exact);
  fail_call(0);
  static_cast<void>(scene.trace(rays, Estimator::exact));
  const int count = calls();
  for (int n = 1; n <= count; ++n) {
    fail_call(n);
    film_test::error_of([&] { static_cast<void>(scene.trace(rays, Estimator::exact)); });
    fail_call(0);
    const auto after = scene.trace(rays, Estimator::exact);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_EQ(after[i].transmittance, before[i].transmittance) << "failure " << n;
  }
}

// Pixel packets take their work by tickets, which the host and the device both count. Both counts
// must agree after a failure, even of the first write of the device's count.
TEST_F(OpenclFailure, LeavesHostAndDeviceTicketsEqual) {
  const Scene scene = make_procedural("scene:cloud?leaves=300&opacity=0.5");
  const SceneBvh bvh = build_bvh(scene);
  const auto rays = scene_test::rays_through(bvh.bounds, 700, 5, 0, 1);
  const auto find = [&](const Device& device, const DeviceScene& uploaded) {
    std::vector<float> found;
    for (const Occlusion& one : trace(device, uploaded, rays, Estimator::exact))
      found.push_back(one.transmittance);
    return found;
  };
  const auto on_new_device = [&](int failing) {
    const Device device("", "", Packets::pixel);
    const DeviceScene uploaded = upload(device, scene, bvh);
    fail_call(failing);
    if (failing) film_test::error_of([&] { static_cast<void>(find(device, uploaded)); });
    fail_call(0);
    return find(device, uploaded);
  };
  const std::vector<float> expected = on_new_device(0);
  const int count = calls();
  EXPECT_EQ(std::count(expected.begin(), expected.end(), 0.0f), 0);  // rays not traced would have 0
  for (int n = 1; n < count; ++n) EXPECT_EQ(on_new_device(n), expected) << "failure " << n;
}

}  // namespace
}  // namespace dapple
