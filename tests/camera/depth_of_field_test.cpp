// Depth of field: the image of a small square is compared with the circle of confusion of a thin
// lens (Cook, Porter and Carpenter, "Distributed Ray Tracing", 1984).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "camera/view.hpp"
#include "dapple/error.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr int kSide = 96;         // pixels
constexpr float kDepth = 4;       // of the square, metres
constexpr float kSquare = 0.08f;  // its side, metres

Camera lens_at_origin(Camera::Kind kind, float radius, float focus) {
  Camera camera;
  camera.kind = kind;
  camera.fov_y = 2 * std::atan(0.25f);  // a picture of half height 0.25 at distance 1
  camera.half_height = 1;               // and of 1 m in parallel projection
  camera.lens_radius = radius;
  camera.focus_distance = focus;
  return camera;
}

// An upright square in front of the origin.
Scene scene_with(const Camera& camera) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  Mesh mesh;
  append_grid(mesh, {-kSquare / 2, -kSquare / 2, -kDepth}, {kSquare, 0, 0}, {0, kSquare, 0}, 1, 0);
  place(scene, std::move(mesh));
  scene.cameras.push_back(camera);
  return scene;
}

Film picture_of_square(const Camera& camera) {
  RenderOptions options;
  options.width = options.height = kSide;
  options.spp = 1024;
  options.ao = options.light = false;
  return render(scene_with(camera), options).film;
}

// The alpha of the square's image as a distribution over the picture, in pixels.
struct Spread {
  double mass = 0, mean = 0, variance = 0, largest_radius = 0;
};

Spread spread_of(const Film& film) {
  const std::vector<float>& alpha = film.find("A")->pixels;
  Spread s;
  double first = 0, second = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double a = alpha[static_cast<std::size_t>(y * kSide + x)];
      const double from_middle = x + 0.5 - kSide / 2.0;
      s.mass += a;
      first += a * from_middle;
      second += a * from_middle * from_middle;
      if (a > 0)
        s.largest_radius =
            std::max(s.largest_radius, std::hypot(from_middle, y + 0.5 - kSide / 2.0));
    }
  }
  s.mean = first / s.mass;
  s.variance = second / s.mass - s.mean * s.mean;
  return s;
}

// Variance along an axis of a sharp square about the middle of the picture, as pixels see it.
double variance_of_pixels(double side) {
  double mass = 0, second = 0;
  for (int i = 0; i < kSide / 2; ++i) {
    const double covered = std::clamp(side / 2 - i, 0.0, 1.0), from_middle = i + 0.5;
    mass += covered;
    second += covered * from_middle * from_middle;
  }
  return second / mass;
}

// A uniform disk of radius r has the variance r^2/4 along an axis; the square and the pixel, of
// sides a and 1, add a^2/12 and 1/12. Some 15,000 samples hit: their number, mean and variance have
// standard errors below 0.01, 0.05 and 0.015 (relative, pixels, relative).
void expect_circle(const Spread& seen, double radius, double side) {
  EXPECT_NEAR(seen.mass, side * side, 0.03 * side * side);
  EXPECT_NEAR(seen.mean, 0, 0.15);
  const double expected =
      radius > 0 ? radius * radius / 4 + side * side / 12 + 1.0 / 12 : variance_of_pixels(side);
  EXPECT_NEAR(seen.variance, expected, 0.045 * expected);
  EXPECT_LE(seen.largest_radius, radius + side / std::sqrt(2.0) + 1);
}

TEST(DepthOfField, ASmallSquareBecomesTheThinLensCircleOfConfusion) {
  const double pixels = kSide / 2 / 0.25;  // a unit of the image plane at distance 1
  for (const float focus : {2.0f, 4.0f, 40.0f}) {
    const float radius = 0.2f;
    const Spread seen =
        spread_of(picture_of_square(lens_at_origin(Camera::Kind::perspective, radius, focus)));
    expect_circle(seen, radius * std::fabs(1 / kDepth - 1 / focus) * pixels,
                  kSquare / kDepth * pixels);
  }
}

TEST(DepthOfField, AnOrthographicLensBlursByTheDistanceFromTheFocus) {
  const double pixels = kSide / 2;  // a metre
  for (const float focus : {3.0f, 4.0f, 8.0f}) {
    const float radius = 0.4f;
    const Spread seen =
        spread_of(picture_of_square(lens_at_origin(Camera::Kind::orthographic, radius, focus)));
    expect_circle(seen, radius * std::fabs(1 - kDepth / focus) * pixels, kSquare * pixels);
  }
}

TEST(DepthOfField, ALensOfRadiusZeroIsAPinholeBitForBit) {
  const Film pinhole = picture_of_square(lens_at_origin(Camera::Kind::perspective, 0, 0));
  const Film closed = picture_of_square(lens_at_origin(Camera::Kind::perspective, 0, 2));
  for (const Plane& plane : pinhole.planes)
    EXPECT_EQ(plane.pixels, closed.find(plane.channel)->pixels) << plane.channel;
}

Camera chosen(const Scene& scene, const RenderOptions& options) {
  std::vector<std::string> notes;
  return choose_view(scene, options, notes).camera;
}

TEST(DepthOfField, OptionsReplaceTheCamerasLensAndTheFocusIsOnTheSceneByDefault) {
  const Scene scene = scene_with(lens_at_origin(Camera::Kind::perspective, 0.1f, 7));
  EXPECT_FLOAT_EQ(chosen(scene, {}).focus_distance, 7);
  RenderOptions options;
  options.aperture = 0.3f;
  EXPECT_FLOAT_EQ(chosen(scene, options).lens_radius, 0.3f);
  EXPECT_FLOAT_EQ(chosen(scene, options).focus_distance, 7);
  options.focus_distance = 5.0f;
  EXPECT_FLOAT_EQ(chosen(scene, options).focus_distance, 5);

  const Scene pinhole = scene_with(lens_at_origin(Camera::Kind::perspective, 0, 0));
  options.focus_distance.reset();
  EXPECT_NEAR(chosen(pinhole, options).focus_distance, kDepth, 1e-5);
  options.look = LookAt{{0, 0, 3}, {0, 0, 1}, {0, 1, 0}};
  EXPECT_NEAR(chosen(pinhole, options).focus_distance, 2, 1e-5);
}

TEST(DepthOfField, AFocusWithoutALensAndASceneBehindTheCameraAreRefused) {
  RenderOptions options;
  options.focus_distance = 2.0f;
  const Camera pinhole = lens_at_origin(Camera::Kind::perspective, 0, 0);
  EXPECT_THROW(chosen(scene_with(pinhole), options), Error);
  Camera away = pinhole;
  away.to_world[3][2] = -2 * kDepth;
  RenderOptions lens;
  lens.aperture = 0.1f;
  EXPECT_THROW(chosen(scene_with(away), lens), Error);
}

}  // namespace
}  // namespace dapple
