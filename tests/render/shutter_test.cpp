// Motion blur: the mean over the moments of a shutter is compared with the coverage of a square and
// of a disk that move, with plain pictures of scenes that stand still, and with the mean of
// pictures of single moments, some of which are smooth and some flat, and of a tree in the wind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "dapple/error.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/smooth_shapes.hpp"
#include "support/scenes/swaying_tree.hpp"

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

constexpr double kRadius = 0.3, kFirst = 0.8, kWay = 2.4;  // of a disk, metres

// The same camera above a disk whose middle is at x = `middle` metres of the picture.
Scene disk_at(double middle) {
  constexpr std::uint32_t kCorners = 256;
  Scene scene = square_at(0);
  Mesh disk;
  disk.positions.emplace_back(0, 0, -3);
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const double angle = 2 * kPi * i / kCorners;
    disk.positions.emplace_back(kRadius * std::cos(angle), kRadius * std::sin(angle), -3);
    disk.indices.insert(disk.indices.end(), {0, i + 1, (i + 1) % kCorners + 1});
    disk.materials.push_back(0);
  }
  scene.meshes[0] = std::move(disk);
  scene.instances[0].to_world[3][0] = static_cast<float>(middle - 2);
  return scene;
}

// Share of the time for which the disk covers a point: half a chord to either side of it.
double time_covered(double x, double y) {
  if (std::fabs(y) >= kRadius) return 0;
  const double half = std::sqrt(kRadius * kRadius - y * y);
  return std::max(0.0, std::min(x + half, kFirst + kWay) - std::max(x - half, kFirst)) / kWay;
}

TEST(Shutter, AMovingDiskCoversAPointForTheTimeThatItsChordTakes) {
  constexpr int kTimes = 64, kParts = 16;
  const auto scene_at = [](int k) { return disk_at(kFirst + kWay * (k + 0.5) / kTimes); };
  const Film film = Renderer().render_shutter(scene_at, kTimes, small_picture(1024)).film;
  const std::vector<float>& alpha = film.find("A")->pixels;
  double area = 0;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      double expected = 0;
      for (int i = 0; i < kParts * kParts; ++i)
        expected += time_covered((column + (i % kParts + 0.5) / kParts) * 0.1,
                                 (row + (i / kParts + 0.5) / kParts) * 0.1 - 0.4) /
                    (kParts * kParts);
      const double seen = double{alpha[row * kWidth + column]};
      // The time of each end is off by up to half a moment, evened out over a pixel, which an end
      // takes 2.7 moments to cross; of 16 samples a moment one or two are off.
      EXPECT_NEAR(seen, expected, 0.5 / kTimes) << column << ", " << row;
      area += seen * 0.01;
    }
  }
  EXPECT_NEAR(area, kPi * kRadius * kRadius, 0.001);
}

/// A sphere that is smooth, or has the normals of its faces; of the same triangles.
Scene sphere(bool is_smooth) {
  Scene scene = test::scene_of(test::smooth_sphere(8, 5));
  if (!is_smooth) std::fill(scene.meshes[0].normals.begin(), scene.meshes[0].normals.end(), V3f(0));
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 0.8f;
  camera.to_world.setTranslation(V3f(0, 0, 3));
  scene.cameras.push_back(camera);
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = V3f(-1, -1, -1).normalized();
  sun.angular_radius = 0.02f;
  sun.radiance = V3f(1000);
  scene.lights = {sun};
  return scene;
}

// What is smooth at any moment has layers of both normals; at flat moments they are the same.
TEST(Shutter, NormalsMayComeAndGoWhileItIsOpen) {
  RenderOptions options = small_picture(64);
  options.light = true;
  for (const bool albedo : {false, true}) {
    options.albedo = albedo;
    for (const bool smooth_first : {false, true}) {
      const auto scene_at = [&](int k) { return sphere((k == 0) == smooth_first); };
      const Film film = Renderer().render_shutter(scene_at, 2, options).film;
      const Film smooth = render(sphere(true), options).film;
      const Film flat = render(sphere(false), options).film;
      ASSERT_NE(film.find("Ng.X"), nullptr);
      ASSERT_EQ(flat.find("Ng.X"), nullptr);
      double difference = 0;
      for (const char* channel : {"N.X", "N.Y", "ao.R", "light.sun.R", "albedo.G", "Ng.Y"}) {
        if (!film.find(channel)) continue;
        const std::string in_flat = std::string(channel) == "Ng.Y" ? "N.Y" : channel;
        for (std::size_t p = 0; p < film.find(channel)->pixels.size(); ++p) {
          const double a = double{smooth.find(channel)->pixels[p]};
          const double b = double{flat.find(in_flat)->pixels[p]};
          if (film.find("A")->pixels[p] < 1) continue;
          // Half of the samples of each picture: 32 of a pixel, in which facets may meet.
          EXPECT_NEAR(film.find(channel)->pixels[p], 0.5 * (a + b), 0.04) << channel << " " << p;
          difference = std::max(difference, std::fabs(a - b));
        }
      }
      EXPECT_GT(difference, 0.2) << "of smooth and flat";
    }
  }
}

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t p = 0; p < a.size(); ++p) sum += std::fabs(double{a[p]} - double{b[p]});
  return sum / static_cast<double>(a.size());
}

// The second moment builds the BVH anew, with what a refit needs, and the third refits it. Of each
// pixel's camera rays the moments have thirds: those of the three shards of a picture. Exact rays
// hit the same triangles in any BVH, so that only sums are rounded. Prefiltered, a refitted tree is
// within 0.003 of a fresh one (tests/render/renderer_test.cpp), and has a third of the rays.
TEST(Shutter, ATreeInTheWindIsTheMeanOfFreshPicturesOfItsMoments) {
  constexpr int kTimes = 3;
  const Scene calm = make_procedural("scene:tree?leaves=2000");
  RenderOptions options;
  options.width = options.height = 48;
  options.spp = 4 * kTimes;
  options.look = LookAt{V3f(0, 6, 24), V3f(0, 5, 0), V3f(0, 1, 0)};
  const auto scene_at = [&](int k) {
    return motion::swayed(calm, 0.1f + 0.7f * static_cast<float>(k));
  };
  const auto fresh = [&](int k) {
    RenderOptions part = options;
    part.shard = {k + 1, kTimes};
    return render(scene_at(k), part).film;
  };
  for (const auto& [estimator, tolerance] :
       {std::pair(Estimator::exact, 1e-6), std::pair(Estimator::prefiltered, 0.001)}) {
    options.estimator = estimator;
    const RenderResult open = Renderer().render_shutter(scene_at, kTimes, options);
    EXPECT_EQ(open.statistics.refit.objects_refitted, 1u);
    EXPECT_EQ(open.statistics.refit.objects_rebuilt, 0u);
    const Film parts[kTimes] = {fresh(0), fresh(1), fresh(2)};
    for (const char* channel : {"A", "ao.R", "light.sky.R", "light.sun.G"}) {
      SCOPED_TRACE(name_of(estimator) + " " + channel);
      const auto of = [&](const Film& film) { return film.find(channel)->pixels; };
      std::vector<float> mean = of(parts[0]);
      for (std::size_t p = 0; p < mean.size(); ++p)
        mean[p] = (mean[p] + of(parts[1])[p] + of(parts[2])[p]) / kTimes;
      EXPECT_LT(mean_difference(of(open.film), mean), tolerance);
      EXPECT_GT(mean_difference(of(parts[1]), of(parts[2])) / kTimes, 2 * tolerance);
    }
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

// Sums have the units of all moments: those of a light of a hundredth of a millimetre would leave
// no room for one of half a metre.
TEST(Shutter, ALightThatGrowsWhileItIsOpenGivesTheMeanOfItsMoments) {
  const auto with_light = [](float side) {
    Scene scene = square_at(1);
    Light light;
    light.name = "lamp";
    light.position = {0, 0, 1};
    light.direction = {0, 0, -1};
    light.edge_u = {side, 0, 0};
    light.edge_v = {0, side, 0};
    scene.lights.push_back(light);
    return scene;
  };
  const auto mean = [](const Film& film) {
    const std::vector<float>& values = film.find("light.lamp.R")->pixels;
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  RenderOptions options = small_picture(64);
  options.ao = false;
  options.light = true;
  const double grown = mean(render(with_light(0.5f), options).film);
  EXPECT_GT(grown, 1e-4);
  for (const float first : {1e-5f, 1e-3f}) {
    const auto scene_at = [&](int k) { return with_light(k == 0 ? first : 0.5f); };
    EXPECT_NEAR(mean(Renderer().render_shutter(scene_at, 4, options).film), 0.75 * grown,
                0.01 * grown)
        << first;
  }
}

TEST(Shutter, SecondsOfItsMomentsCountOnce) {
  const Scene calm = make_procedural("scene:tree?leaves=20000");
  const auto scene_at = [&](int k) {
    return motion::swayed(calm, 0.1f * static_cast<float>(k + 1));
  };
  const RenderResult result = Renderer().render_shutter(scene_at, 8, small_picture(8));
  const auto& s = result.statistics.seconds;
  const double sum = s.prepare + s.cache + s.build + s.prefilter + s.refit + s.upload +
                     s.kernel_build + s.trace + s.checkpoint + s.develop;
  EXPECT_NEAR(sum, s.total, 0.01 * s.total);
  EXPECT_GT(s.refit, 0.02 * s.total) << "too little to be missed if it counted twice";
  EXPECT_GE(s.trace, 0);
  EXPECT_GE(s.develop, 0);
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
  EXPECT_THROW(Renderer().render_shutter({}, 2, small_picture(8)), Error) << "without scenes";
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
