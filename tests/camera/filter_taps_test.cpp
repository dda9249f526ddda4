// Filter taps: where texels are smaller than pixels, a camera ray looks up the texture at four
// points of its pixel. The mean of a pixel must be that of exact rays, for every direction of card
// and camera, with less noise; and a ray's result must not depend on the other rays of its packet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr int kTexels = 256;  // along each axis of the texture

/// A texture of blots, each some texels wide, with sharp or soft edges.
Texture blots(bool sharp) {
  Texture texture{"blots", kTexels, kTexels, {}};
  std::mt19937 random(1);
  std::vector<float> phase(12);
  for (float& value : phase) value = static_cast<float>(random() % 6283) / 1000;
  for (int y = 0; y < kTexels; ++y) {
    for (int x = 0; x < kTexels; ++x) {
      float sum = 0;
      for (std::size_t k = 0; k < phase.size(); ++k) {
        // A whole number of waves, so that the texture tiles without seams.
        const float waves_x = static_cast<float>(11 + 7 * k % 23) * (k % 2 ? 1.0f : -1.0f);
        const float waves_y = static_cast<float>(9 + 5 * k % 29);
        const float turn = 2 * static_cast<float>(kPi) / kTexels;
        sum += std::sin(turn * (waves_x * static_cast<float>(x) + waves_y * static_cast<float>(y)) +
                        phase[k]);
      }
      const float alpha =
          sharp ? (sum > 0.5f ? 1.0f : 0.0f) : std::clamp(0.5f + sum / 8, 0.0f, 1.0f);
      texture.alpha.push_back(static_cast<std::uint8_t>(std::lround(255 * alpha)));
    }
  }
  return texture;
}

/// A square of `side` metres around `middle`, rotated by `degrees`, with the whole texture.
struct Card {
  V3f middle, degrees;
  float side;
};

Scene cards(const std::vector<Card>& layout, bool sharp) {
  Scene scene;
  scene.source = "cards";
  scene.textures.push_back(blots(sharp));
  Material material;
  material.name = "card";
  material.alpha_mode = sharp ? AlphaMode::mask : AlphaMode::blend;
  material.alpha_cutoff = 0.5f;
  material.alpha_texture = 0;
  scene.materials.push_back(material);
  Mesh mesh;
  for (const Card& card : layout) {
    M44f turn;
    turn.setEulerAngles(card.degrees * static_cast<float>(kPi / 180));
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const V2f& uv : {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)}) {
      mesh.positions.push_back(card.middle + (V3f(uv.x - 0.5f, uv.y - 0.5f, 0) * card.side) * turn);
      mesh.uvs.push_back(uv);
    }
    for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u})
      mesh.indices.push_back(first + corner);
    mesh.materials.insert(mesh.materials.end(), 2, 0);
  }
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({0, M44f(), -1});
  return scene;
}

void add_camera(Camera::Kind kind, Scene& scene) {
  Camera camera;
  camera.kind = kind;
  camera.half_height = 1;
  camera.fov_y = 2 * std::atan(0.25f);
  camera.to_world.setTranslation(V3f(0, 0, 4));
  scene.cameras.push_back(camera);
}

RenderOptions picture(int size, int spp) {
  RenderOptions options;
  options.width = options.height = size;
  options.spp = spp;
  options.camera_splitting = 4;
  options.ao = options.light = false;
  return options;
}

using Coverage = std::vector<double>;

/// With the device and the BVH of the last picture: there are hundreds.
Film film_of(const Scene& scene, const RenderOptions& options) {
  static Renderer renderer;
  return renderer.render(scene, options).film;
}

Coverage coverage(const Scene& scene, const RenderOptions& options) {
  const std::vector<float> pixels = film_of(scene, options).find("A")->pixels;
  return {pixels.begin(), pixels.end()};
}

double rmse(const Coverage& a, const Coverage& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

struct Errors {
  double noise, bias;  ///< rms over pixels: of one picture's noise, and of the mean of many
};

/// Errors of pictures with 8 samples a pixel, compared with many exact rays.
Errors errors(const Scene& scene, Estimator estimator) {
  constexpr int kSize = 24, kPictures = 12;
  RenderOptions exact = picture(kSize, 512);
  exact.estimator = Estimator::exact;
  const Coverage truth = coverage(scene, exact);
  Coverage mean(truth.size());
  double squares = 0;
  for (int i = 0; i < kPictures; ++i) {
    RenderOptions options = picture(kSize, 8);
    options.estimator = estimator;
    options.seed = static_cast<std::uint32_t>(i + 1);
    const Coverage found = coverage(scene, options);
    squares += rmse(found, truth) * rmse(found, truth) / kPictures;
    for (std::size_t p = 0; p < mean.size(); ++p) mean[p] += found[p] / kPictures;
  }
  const double of_mean = rmse(mean, truth);
  const double noise = std::sqrt((squares - of_mean * of_mean) * kPictures / (kPictures - 1));
  return {noise, std::sqrt(std::max(0.0, of_mean * of_mean - noise * noise / kPictures))};
}

/// A card of 4 m that fills the picture, with some 8 texels a pixel. `scale`: scale of the instance
/// that is visible; 1: not instanced.
Scene large_card(V3f degrees, Camera::Kind kind, bool sharp, float scale = 1) {
  Scene scene = cards({{V3f(0, 0, 0), degrees, 4 / scale}}, sharp);
  if (scale != 1) {
    add_triangles_out_of_sight(scene.meshes[0]);
    scene.instances.push_back(scene.instances[0]);
    scene.instances[0].to_world.setScale(scale);
    scene.instances[1].to_world[3][2] = 50;
  }
  add_camera(kind, scene);
  return scene;
}

// The limit of the bias finds errors in the taps: with right and left exchanged, or without
// centring on the pixel, the largest biases are 0.018 and 0.017.
TEST(FilterTaps, AreLessNoisyThanExactRaysAndHaveLittleBias) {
  const Scene scenes[] = {
      large_card(V3f(0, 0, 30), Camera::Kind::orthographic, true),
      large_card(V3f(50, 20, 10), Camera::Kind::orthographic, true, 0.25f),
      large_card(V3f(-30, 55, 200), Camera::Kind::perspective, true),
      large_card(V3f(50, 20, 10), Camera::Kind::perspective, false, 3),
  };
  for (const Scene& scene : scenes) {
    const Errors tapped = errors(scene, Estimator::prefiltered);
    const Errors single = errors(scene, Estimator::exact);
    EXPECT_LT(tapped.noise, 0.98 * single.noise);
    EXPECT_LT(tapped.bias, 0.016);
  }
}

/// An atlas with one leaf: a disk in the middle sixteenth of the area.
Texture disk() {
  Texture texture{"disk", kTexels, kTexels, {}};
  for (int y = 0; y < kTexels; ++y)
    for (int x = 0; x < kTexels; ++x)
      texture.alpha.push_back(std::hypot(x - 127.5, y - 127.5) < 25.5 ? std::uint8_t{255}
                                                                      : std::uint8_t{0});
  return texture;
}

// Taps outside the card find nothing, and distant foliage would fade: cards of 0.4 pixels would
// keep 0.19 of their coverage.
TEST(FilterTaps, StayOnCardsSmallerThanPixels) {
  Points points(5);
  // The mean of four mip footprints reaches beyond small cards, hence these tolerances.
  for (const auto& [pixels, tolerance] :
       {std::pair{0.4f, 0.05}, std::pair{1.0f, 0.07}, std::pair{4.0f, 0.02}}) {
    std::vector<Card> layout;
    for (int i = 0; i < 400; ++i)
      layout.push_back(
          {V3f(points.unit() - 0.5f, points.unit() - 0.5f, points.unit() - 0.5f) * 1.8f,
           V3f(points.unit() - 0.5f, points.unit() - 0.5f, 1) * 90, pixels * 2 / 24});
    Scene scene = cards(layout, true);
    scene.textures[0] = disk();
    for (V2f& uv : scene.meshes[0].uvs) uv = V2f(0.5f) + (uv - V2f(0.5f)) * 0.25f;
    add_camera(Camera::Kind::orthographic, scene);
    RenderOptions options = picture(24, 8), exact = picture(24, 256);
    exact.estimator = Estimator::exact;
    double found = 0, truth = 0;
    for (std::uint32_t seed = 0; seed < 24; ++seed) {
      options.seed = seed;
      for (const double value : coverage(scene, options)) found += value / 24;
    }
    for (const double value : coverage(scene, exact)) truth += value;
    EXPECT_NEAR(found / truth, 1, tolerance) << pixels;
  }
}

/// Small and large cards with random directions, in two meshes: one in the world, one in two
/// instances.
Scene scattered_cards() {
  Points points(3);
  const auto some = [&](int count, float middle, float side) {
    std::vector<Card> layout;
    for (int i = 0; i < count; ++i)
      layout.push_back(
          {V3f(points.unit() - 0.5f, points.unit() - 0.5f, points.unit() - 0.5f) * middle,
           V3f(points.unit(), points.unit(), points.unit()) * 360, side});
    return layout;
  };
  Scene scene = cards(some(300, 2.2f, 0.4f), true);
  scene.meshes.push_back(cards(some(700, 1.0f, 0.1f), true).meshes[0]);
  for (const float x : {-0.6f, 0.6f}) {
    Instance placed = scene.instances[0];
    placed.mesh = 1;
    placed.to_world.setEulerAngles(V3f(0.3f, x, 0.1f));
    placed.to_world[3][0] = x;
    scene.instances.push_back(placed);
  }
  return scene;
}

TEST(FilterTaps, DoNotDependOnTheOtherRaysOfThePacket) {
  for (const Camera::Kind kind : {Camera::Kind::orthographic, Camera::Kind::perspective}) {
    Scene scene = scattered_cards();
    add_camera(kind, scene);
    RenderOptions options = picture(40, 8);
    options.ao = true;
    const Film whole = film_of(scene, options);
    double seen = 0;
    for (const PixelRect& crop : {PixelRect{20, 20, 20, 20}, PixelRect{11, 17, 11, 17},
                                  PixelRect{5, 9, 6, 30}, PixelRect{3, 2, 36, 37}}) {
      options.crop = crop;
      const Film part = film_of(scene, options);
      for (const char* channel : {"A", "Z", "ao.R"}) {
        const std::vector<float>& pixels = part.find(channel)->pixels;
        auto at = pixels.begin();
        for (int y = crop.y0; y <= crop.y1; ++y) {
          for (int x = crop.x0; x <= crop.x1; ++x, ++at) {
            const float expected =
                whole.find(channel)->pixels[static_cast<std::size_t>(y * 40 + x)];
            ASSERT_EQ(std::memcmp(&*at, &expected, sizeof(float)), 0)
                << channel << " at " << x << ", " << y << ": " << *at << " for " << expected;
            seen += *at > 0;
          }
        }
      }
    }
    EXPECT_GT(seen, 1000);
  }
}

}  // namespace
}  // namespace dapple
