// Motion blur: the mean over the moments of a shutter is compared with the coverage of a square
// that moves, and with plain pictures of scenes that stand still.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "dapple/error.hpp"
#include "support/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr int kWidth = 40, kHeight = 8;  // a pixel is 0.1 m
constexpr float kSide = 1;               // of the square, metres

// A parallel camera above a square, whose left side is at x = `left` metres of the picture.
Scene square_at(float left) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  Mesh mesh;
  append_grid(mesh, {0, -kSide, -3}, {kSide, 0, 0}, {0, 2 * kSide, 0}, 1, 0);
  place(scene, std::move(mesh));
  scene.instances[0].to_world[3][0] = left - 2;
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 0.4f;
  scene.cameras.push_back(camera);
  return scene;
}

RenderOptions small_picture(int spp) {
  RenderOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.spp = spp;
  options.light = false;
  return options;
}

// How much of the pixel column is covered by a square whose left side is at `left` metres.
double coverage(int column, double left) {
  const double begin = column * 0.1, end = begin + 0.1;
  return std::clamp((std::min(end, left + kSide) - std::max(begin, left)) / 0.1, 0.0, 1.0);
}

TEST(Shutter, AMovingSquareCoversPixelsForTheShareOfMomentsThatItIsThere) {
  constexpr int kTimes = 8;
  const auto left = [](int k) { return 0.45f + 0.23f * static_cast<float>(k); };
  const Film film =
      Renderer()
          .render_shutter([&](int k) { return square_at(left(k)); }, kTimes, small_picture(256))
          .film;
  const std::vector<float>& alpha = film.find("A")->pixels;
  for (int column = 0; column < kWidth; ++column) {
    double expected = 0;
    for (int k = 0; k < kTimes; ++k) expected += coverage(column, left(k)) / kTimes;
    double seen = 0;
    for (int row = 0; row < kHeight; ++row) seen += alpha[row * kWidth + column] / kHeight;
    // Eight rows of 32 stratified samples a moment: an edge is off by less than 1/32 in each.
    EXPECT_NEAR(seen, expected, 1.0 / 32 / kTimes + 1e-6) << column;
  }
}

TEST(Shutter, AStillSceneHasTheBitsOfAPictureWithoutAShutter) {
  const RenderOptions options = small_picture(16);
  const RenderResult plain = render(square_at(1.03f), options);
  for (const int times : {1, 3, 16}) {
    const RenderResult open =
        Renderer().render_shutter([&](int) { return square_at(1.03f); }, times, options);
    for (const Plane& plane : plain.film.planes)
      EXPECT_EQ(open.film.find(plane.channel)->pixels, plane.pixels) << plane.channel << times;
  }
}

TEST(Shutter, ProgressRisesToOne) {
  double last = 0;
  RenderControl control;
  control.progress = [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  const auto moving = [](int k) { return square_at(0.5f * static_cast<float>(k)); };
  Renderer().render_shutter(moving, 4, small_picture(8), control);
  EXPECT_NEAR(last, 1, 1e-9);
}

TEST(Shutter, AStopKeepsTheSamplesSoFar) {
  int slices = 0;
  RenderControl control;
  control.stop = [&] { return slices++ >= 1; };
  const auto moving = [](int k) { return square_at(0.5f * static_cast<float>(k)); };
  const RenderResult result = Renderer().render_shutter(moving, 4, small_picture(8), control);
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.film.find("samples")->pixels[0], 2);
}

void expect_refused(const std::function<void(RenderOptions&, RenderControl&)>& change, int times) {
  RenderOptions options = small_picture(8);
  RenderControl control;
  change(options, control);
  try {
    Renderer().render_shutter([](int) { return square_at(1); }, times, options, control);
    ADD_FAILURE() << "was not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
  }
}

TEST(Shutter, TargetsCheckpointsGroundsAndTooManyMomentsAreRefused) {
  expect_refused([](RenderOptions& o, RenderControl&) { o.target_rmse = 0.1f; }, 2);
  expect_refused([](RenderOptions& o, RenderControl&) { o.ground = true; }, 2);
  expect_refused([](RenderOptions&, RenderControl& c) { c.checkpoint = "a.ckpt"; }, 2);
  expect_refused([](RenderOptions&, RenderControl&) {}, 9);
  expect_refused([](RenderOptions&, RenderControl&) {}, 0);
}

TEST(Shutter, LightsThatComeWhileItIsOpenAreRefused) {
  RenderOptions options = small_picture(8);
  options.light = true;
  const auto scene_at = [](int k) {
    Scene scene = square_at(1);
    scene.lights.resize(1 + static_cast<std::size_t>(k));
    return scene;
  };
  EXPECT_THROW(Renderer().render_shutter(scene_at, 2, options), Error);
}

}  // namespace
}  // namespace dapple
