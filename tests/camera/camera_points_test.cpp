// Parts of the camera pass: hit points of sixteen rays at once against those of single rays; and
// the rounding of sums to fixed point, which must agree with OpenCL's saturating conversion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "camera/view.hpp"
#include "dapple/shared/geometry.h"
#include "dapple/shared/segment_block.h"
#include "support/test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

/// Sixteen rays, each through a point of one triangle of two blocks. Some of the triangles belong
/// to an instance.
class PlacedRays {
 public:
  PlacedRays() : blocks_(2), instances_(1) {
    InstanceRecord& instance = instances_[0];
    // Scaled by 2, rotated from x to y, and translated.
    const float to_world[12] = {0, -2, 0, 1, 2, 0, 0, -1, 0, 0, 2, 3};
    const float to_object[12] = {0, 0.5f, 0, 0.5f, -0.5f, 0, 0, 0.5f, 0, 0, 0.5f, -1.5f};
    std::copy_n(to_world, 12, instance.to_world);
    std::copy_n(to_object, 12, instance.to_object);
    for (uint i = 0; i < 16; ++i) add(i, i % 3 == 1);
    add_edge_on();
  }

  void expect_alike() const {
    const Buffer together = device().allocate(16 * 7 * sizeof(float));
    const Buffer alone = device().allocate(16 * 7 * sizeof(float));
    const std::vector<SegmentBlock> none(1);
    run("film_and_camera", "placed_points", 1,
        {upload(blocks_), upload(none), upload(instances_), upload(rays_), upload(primitives_),
         upload(placements_), together, alone});
    const auto a = download<float>(together, 16 * 7), b = download<float>(alone, 16 * 7);
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_TRUE(std::isfinite(a[i])) << "ray " << i / 7;
      EXPECT_NEAR(a[i], b[i], 2e-6f) << "ray " << i / 7 << ", " << i % 7;
    }
    for (std::size_t i = 0; i < 15; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(a[7 * i + axis], hits_[3 * i + axis], 1e-5f) << "ray " << i;
  }

 private:
  void add(uint i, bool placed) {
    const V3f vertex(random(), random(), random()), edge1(random(), random(), 1.0f),
        edge2(random(), 1.0f, random());
    TriangleBlock& block = blocks_[i / 8];
    for (int axis = 0; axis < 3; ++axis) {
      block.vertex[0][axis][i % 8] = vertex[axis];
      block.vertex[1][axis][i % 8] = vertex[axis] + edge1[axis];
      block.vertex[2][axis][i % 8] = vertex[axis] + edge2[axis];
    }
    V3f hit = vertex + 0.3f * edge1 + 0.4f * edge2;
    const float* m = instances_[0].to_world;
    const auto row = [&](int r) {
      return m[4 * r] * hit.x + m[4 * r + 1] * hit.y + m[4 * r + 2] * hit.z + m[4 * r + 3];
    };
    if (placed) hit = V3f(row(0), row(1), row(2));
    const V3f direction = V3f(random(), random(), random()).normalized();
    const V3f origin = hit - 3.0f * direction;
    for (const float value : {origin.x, origin.y, origin.z, direction.x, direction.y, direction.z})
      rays_.push_back(value);
    rays_.push_back(3.0f);
    primitives_.push_back(i);
    placements_.push_back(placed ? 0u : ~0u);
    hits_.insert(hits_.end(), {hit.x, hit.y, hit.z});
  }
  /// The last ray lies in the plane of its triangle.
  void add_edge_on() {
    TriangleBlock& block = blocks_[1];
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, ray[6] = {0.25f, -1, 0, 0, 1, 0};
    for (int i = 0; i < 9; ++i) block.vertex[i / 3][i % 3][7] = corners[i];
    std::copy_n(ray, 6, rays_.end() - 7);
    placements_.back() = ~0u;
  }
  float random() { return std::uniform_real_distribution<float>(-1, 1)(random_); }

  std::mt19937 random_{5};
  std::vector<TriangleBlock> blocks_;
  std::vector<InstanceRecord> instances_;
  std::vector<float> rays_, hits_;
  std::vector<uint> primitives_, placements_;
};

TEST(CameraPoints, HitPointsOfSixteenRaysEqualThoseOfSingleRays) { PlacedRays().expect_alike(); }

// A pyramid with half sides w and h at distance 1 has the solid angle 4 atan(w h / sqrt(1 + w^2 +
// h^2)). A pixel is as if it were flat: the midpoint rule is off by less than 1e-3 for these 64 x
// 32 pixels.
TEST(CameraPoints, SolidAnglesOfPixelsAddUpToThatOfThePicture) {
  Camera camera;
  camera.fov_y = std::acos(0.0f);
  const View view{camera, 64, 32, {0, 0, 63, 31}};
  RenderOptions options;
  options.spp = 1;
  const CameraParams params = camera_params(view, options, Box3f(V3f(-1), V3f(1)));
  const uint count = 64 * 32;
  const Buffer out = device().allocate(count * sizeof(float));
  run("film_and_camera", "pixel_solid_angles", count / 16, {out, params, count});
  double sum = 0;
  for (const float solid_angle : download<float>(out, count)) sum += double{solid_angle};
  const double expected = 4 * std::atan(2 * 1 / std::sqrt(1.0 + 4 + 1));
  EXPECT_NEAR(sum, expected, 1e-3 * expected);
}

TEST(FixedPoints, RoundToEvenSaturateAndTakeNanAsZero) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<float> values{0.5f,          1.5f,       2.5f,  -0.5f,      -1.5f,     1e18f,
                                  -3e18f,        8388607.5f, 1e30f, -kInfinity, kInfinity, -1e30f,
                                  std::nanf(""), 0.0f,       0.25f, -7.75f};
  const Buffer in = upload(values);
  const Buffer out = device().allocate(values.size() * sizeof(std::int64_t));
  const auto items = static_cast<uint>(values.size() / 8);
  run("film_and_camera", "to_fixed_points", items, {in, out, items});
  const auto sums = download<std::int64_t>(out, values.size());
  // The largest float below 2^63.
  constexpr std::int64_t kMax = 9223371487098961920;
  const std::vector<std::int64_t> expected{0,
                                           2,
                                           2,
                                           0,
                                           -2,
                                           static_cast<std::int64_t>(1e18f),
                                           static_cast<std::int64_t>(-3e18f),
                                           8388608,
                                           kMax,
                                           -kMax,
                                           kMax,
                                           -kMax,
                                           0,
                                           0,
                                           0,
                                           -8};
  EXPECT_EQ(sums, expected);
}

}  // namespace
}  // namespace dapple
