// The film's channels after render(), on scenes where every value is known: coverage, position,
// normal, depth along the viewing axis, AO where rays miss, and RGBA.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr int kWidth = 24, kHeight = 16;

// A film whose channel values can be read by pixel.
class Picture {
 public:
  explicit Picture(const RenderResult& result) : film_(result.film) {}
  Picture(const Scene& scene, const RenderOptions& options) : Picture(render(scene, options)) {}

  [[nodiscard]] float at(const std::string& channel, int pixel) const {
    const Plane* plane = film_.find(channel);
    EXPECT_NE(plane, nullptr) << channel;
    return plane ? plane->pixels.at(pixel) : 0;
  }
  [[nodiscard]] V3f at3(const std::string& layer, const char (&suffixes)[4], int pixel) const {
    return {at(layer + suffixes[0], pixel), at(layer + suffixes[1], pixel),
            at(layer + suffixes[2], pixel)};
  }
  [[nodiscard]] const Film& film() const { return film_; }

 private:
  Film film_;
};

RenderOptions small_picture() {
  RenderOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.spp = 16;
  options.light = false;
  return options;
}

Scene plane_scene(float side, const Camera& camera) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  place(scene, square_mesh(side, 0, 4, 0));
  scene.cameras.push_back(camera);
  return scene;
}

// The mean position of a pixel's hits must project into that pixel, because perspective maps convex
// sets to convex sets.
void expect_seen_through_pixel(const Picture& picture, const V3f& position, int pixel) {
  V3f ndc;
  picture.film().metadata.world_to_ndc.multVecMatrix(position, ndc);
  EXPECT_NEAR(ndc.x * kWidth, static_cast<float>(pixel % kWidth) + 0.5f, 0.5f + 1e-3f) << pixel;
  EXPECT_NEAR(ndc.y * kHeight, static_cast<float>(pixel / kWidth) + 0.5f, 0.5f + 1e-3f) << pixel;
}

void expect_plane(const Picture& picture, const Camera& camera) {
  const V3f eye(camera.to_world[3][0], camera.to_world[3][1], camera.to_world[3][2]);
  const V3f axis(-camera.to_world[2][0], -camera.to_world[2][1], -camera.to_world[2][2]);
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    EXPECT_EQ(picture.at("A", pixel), 1.0f);
    EXPECT_EQ(picture.at("ao.R", pixel), 1.0f);
    EXPECT_EQ(picture.at("samples", pixel), 16.0f);
    const V3f normal = picture.at3("N.", "XYZ", pixel);
    EXPECT_NEAR((normal - V3f(0, 1, 0)).length(), 0, 1e-6);
    const V3f position = picture.at3("P.", "XYZ", pixel);
    EXPECT_NEAR(position.y, 0, 1e-5);
    expect_seen_through_pixel(picture, position, pixel);
    // Depth is linear in the position, so the mean depth is the depth of the mean position.
    EXPECT_NEAR(picture.at("Z", pixel), (position - eye).dot(axis), 2e-5);
  }
}

TEST(PictureChannels, HoldPositionsNormalsAndDepthsOfAPlane) {
  const Camera perspective = look_at({1, 4, 5}, {0.5f, 0, 0.3f}, {0, 1, 0}, 0.6f);
  expect_plane(Picture(plane_scene(50, perspective), small_picture()), perspective);
  // Below: seen from there, the normal is flipped towards the viewer.
  Camera orthographic = look_at({1, 4, 5}, {0.5f, 0, 0.3f}, {0, 1, 0}, 0.6f);
  orthographic.kind = Camera::Kind::orthographic;
  orthographic.half_height = 1.5f;
  expect_plane(Picture(plane_scene(50, orthographic), small_picture()), orthographic);
  const Camera below = look_at({0, -3, 0.5f}, {0, 0, 0}, {0, 1, 0}, 0.6f);
  const Picture from_below(plane_scene(50, below), small_picture());
  EXPECT_NEAR(from_below.at("N.Y", kWidth / 2), -1, 1e-6);
}

// The camera looks straight down from 10 m at a square of side 4.2 m. At that distance the picture
// is 6 m high and 9 m wide.
TEST(PictureChannels, AoIsOneWherePixelsMissAndDepthIsNotDistance) {
  const float fov = 2 * std::atan(0.3f);
  const Camera down = look_at({0, 10, 0}, {0, 0, 0}, {0, 0, -1}, fov);
  Scene scene = plane_scene(4.2f, down);
  const Picture picture(scene, small_picture());
  double coverage = 0;
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    const float a = picture.at("A", pixel);
    coverage += a / (kWidth * kHeight);
    EXPECT_EQ(picture.at("ao.G", pixel), 1.0f);
    EXPECT_EQ(picture.at("R", pixel), a);  // only AO, premultiplied
    if (a > 0) {
      EXPECT_NEAR(picture.at("Z", pixel), 10, 1e-5);
      EXPECT_NEAR(picture.at("N.Y", pixel), 1, 1e-6);  // mean over hits, however few
    } else {
      EXPECT_EQ(picture.at("Z", pixel), kInfinity);
      EXPECT_EQ(picture.at3("N.", "XYZ", pixel), V3f(0.0f));
      EXPECT_EQ(picture.at3("P.", "XYZ", pixel), V3f(0.0f));
      EXPECT_EQ(picture.at3("bent.", "XYZ", pixel), V3f(0.0f));
    }
  }
  // Each of the about 45 border pixels is off by less than 1 / 16, most by far less.
  EXPECT_NEAR(coverage, 4.2 * 4.2 / (6.0 * 9.0), 45.0 / 16 / (kWidth * kHeight));
}

// At the foot of an endless wall at +X half of the sky is seen. The cosine-weighted mean direction
// from there is (-2/3, pi/3, 0): the integrals of cos sin^2 cos(phi) and of cos^2 sin over that
// half.
TEST(PictureChannels, BentNormalsTurnAwayFromAWall) {
  Camera down = look_at({-0.5f, 5, 0}, {-0.5f, 0, 0}, {0, 0, -1}, 0.02f);
  Scene scene = plane_scene(8000, down);
  Mesh wall;
  append_grid(wall, {0, -1, -4000}, {0, 0, 8000}, {0, 8000, 0}, 1, 0);
  place(scene, std::move(wall));
  RenderOptions options = small_picture();
  options.estimator = Estimator::exact;
  options.ao_rays = 64;
  const Picture picture(scene, options);
  V3f sum(0.0f);
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    EXPECT_NEAR(picture.at("ao.R", pixel), 0.5, 0.1);
    const V3f bent = picture.at3("bent.", "XYZ", pixel);
    EXPECT_NEAR(bent.length(), 1, 1e-5);
    sum += bent;
  }
  const V3f expected = V3f(-2.0f / 3, std::numbers::pi_v<float> / 3, 0).normalized();
  // 400,000 rays, each with a deviation below 1.
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(sum.normalized()[axis], expected[axis], 5e-3) << axis;
}

Light rect_above(const std::string& name, const V3f& radiance, float x) {
  Light light;
  light.name = name;
  light.radiance = radiance;
  light.position = V3f(x, 3, 0);
  return light;
}

TEST(PictureChannels, RgbaIsLightsAndATenthOfThemThroughAoPremultiplied) {
  // A view from the side: sky above, ground below.
  Scene scene = plane_scene(8, look_at({0, 2.5f, 9}, {0, 0.5f, 0}, {0, 1, 0}, 0.5f));
  scene.lights = {rect_above("warm", V3f(3, 2, 1), -2), rect_above("cool", V3f(0.5f, 1, 4), 2)};
  RenderOptions options = small_picture();
  options.light = true;
  options.spp = 32;
  options.estimator = Estimator::exact;
  const Picture free(scene, options);
  double largest = 0;
  std::vector<double> of_samples_that_hit;
  const auto light = [](const Picture& picture, int pixel) {
    return picture.at3("light.warm.", "RGB", pixel) + picture.at3("light.cool.", "RGB", pixel);
  };
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    const V3f sum = light(free, pixel);
    const double brightest = std::max({sum.x, sum.y, sum.z});
    largest = std::max(largest, brightest);
    if (brightest > 0) of_samples_that_hit.push_back(brightest / free.at("A", pixel));
  }
  std::sort(of_samples_that_hit.begin(), of_samples_that_hit.end());
  const double bright = of_samples_that_hit.at((of_samples_that_hit.size() - 1) * 9 / 10);
  // A sheet between the ground and the lights that no camera ray crosses, so camera samples stay
  // the same.
  scene.materials.push_back(material_of(0.5f));
  place(scene, square_mesh(3, 2.75f, 1, 1));
  const Picture shaded(scene, options);
  int partly = 0, darkened = 0;
  for (const Picture* picture : {&free, &shaded}) {
    for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
      const float a = picture->at("A", pixel);
      partly += a > 0 && a < 1;
      darkened += picture->at("ao.R", pixel) < 0.99f;
      const double ao = picture->at("ao.R", pixel) - (1 - a);
      // light.NAME is a mean over all samples: already premultiplied. The materials are white.
      const V3f expected = (light(*picture, pixel) + V3f(static_cast<float>(0.1 * bright * ao))) /
                           std::numbers::pi_v<float>;
      const V3f found(picture->at("R", pixel), picture->at("G", pixel), picture->at("B", pixel));
      for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(found[channel], expected[channel], 1e-5 * largest) << pixel;
      }
    }
  }
  EXPECT_GT(partly, 10);
  EXPECT_GT(darkened, 20);
}

}  // namespace
}  // namespace dapple
