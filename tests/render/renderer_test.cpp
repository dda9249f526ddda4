// Compares the pictures of one Renderer, of a scene that moves from picture to picture, with those
// of separate renders. Also compares AO in refitted and in newly built BVHs, and checks that a
// thousand pictures do not use more and more memory.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <fstream>
#include <numeric>

#include "dapple/error.hpp"
#include "device/context.hpp"
#include "support/sanitizers.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/swaying_tree.hpp"
#include "support/scenes/traced_scenes.hpp"

namespace dapple {
namespace {

using motion::swayed;

RenderOptions small_picture(Estimator estimator, int size = 48, int spp = 8) {
  RenderOptions options;
  options.width = options.height = size;
  options.spp = spp;
  options.estimator = estimator;
  options.look = LookAt{V3f(0, 6, 24), V3f(0, 5, 0), V3f(0, 1, 0)};
  return options;
}

double mean_of(const RenderResult& result, const std::string& channel) {
  const Plane* plane = result.film.find(channel);
  if (!plane) throw Error(ErrorKind::failed, "no channel " + channel);
  return std::accumulate(plane->pixels.begin(), plane->pixels.end(), 0.0) /
         static_cast<double>(plane->pixels.size());
}

double mean_ao(const RenderResult& result) { return mean_of(result, "ao.R"); }

/// Of all launches on the device so far.
double seconds_of(const Device& device) {
  double sum = 0;
  for (const auto& [label, seconds] : device.context().pass_seconds()) sum += seconds;
  return sum;
}

Scene tree(int leaves) { return make_procedural("scene:tree?leaves=" + std::to_string(leaves)); }

TEST(Renderer, PicturesOfAMovingTreeAreThoseOfFreshBvhs) {
  const Scene still = tree(20000);
  for (const auto& [estimator, tolerance] :
       {std::pair(Estimator::exact, 0.0005), std::pair(Estimator::prefiltered, 0.003)}) {
    const RenderOptions options = small_picture(estimator);
    Renderer renderer;
    renderer.render(still, options);
    renderer.render(swayed(still, 0.1f), options);
    for (const float time : {0.5f, 1.5f, 3.1f}) {
      const Scene moved = swayed(still, time);
      const RenderResult refitted = renderer.render(moved, options), fresh = render(moved, options);
      EXPECT_TRUE(refitted.statistics.refit.used);
      EXPECT_EQ(refitted.statistics.refit.objects_refitted, 1u);
      EXPECT_EQ(refitted.statistics.refit.objects_rebuilt, 0u);
      std::printf("%s at %.1f s: AO %.5f, fresh %.5f\n", name_of(estimator).c_str(), time,
                  mean_ao(refitted), mean_ao(fresh));
      EXPECT_NEAR(mean_ao(refitted), mean_ao(fresh), tolerance);
      EXPECT_NEAR(mean_of(refitted, "light.sky.R"), mean_of(fresh, "light.sky.R"), 0.01);
    }
  }
}

TEST(Renderer, TheSamePictureTwiceIsTheSameBits) {
  const Scene still = tree(500);
  const RenderOptions options = small_picture(Estimator::prefiltered);
  Renderer renderer;
  const RenderResult first = renderer.render(still, options),
                     second = renderer.render(still, options), fresh = render(still, options);
  EXPECT_EQ(second.statistics.refit.objects_kept, 1u);
  for (std::size_t p = 0; p < first.film.planes.size(); ++p) {
    EXPECT_EQ(first.film.planes[p].pixels, second.film.planes[p].pixels);
    EXPECT_EQ(first.film.planes[p].pixels, fresh.film.planes[p].pixels);
  }
}

TEST(Renderer, UsesAnOpenDeviceForPicturesThatNameIt) {
  const Device device;
  const Scene still = tree(500);
  RenderOptions options = small_picture(Estimator::prefiltered);
  const RenderResult fresh = render(still, options);
  for (int picture = 0; picture < 2; ++picture) {  // the second has the first one's kernels
    const double before = seconds_of(device);
    const RenderResult made = Renderer(device).render(still, options);
    EXPECT_GT(seconds_of(device), before);
    for (std::size_t p = 0; p < fresh.film.planes.size(); ++p)
      EXPECT_EQ(fresh.film.planes[p].pixels, made.film.planes[p].pixels);
  }
  const double before = seconds_of(device);
  options.packets = Packets::none;
  EXPECT_GT(mean_ao(Renderer(device).render(still, options)), 0);
  EXPECT_EQ(seconds_of(device), before) << "its kernels are others";
  options.device = "no such device";
  EXPECT_THROW(Renderer(device).render(still, options), Error);
}

// Camera rays are traced only in the pixels that can see the scene's bounds. The bounds must move
// with the scene, both for one object that is refitted and for instances that are moved.
TEST(Renderer, WhatMovesAcrossThePictureIsSeenWhereItIs) {
  const RenderOptions options = small_picture(Estimator::exact, 64, 1);
  for (const char* name : {"scene:tree?leaves=300", "scene:forest?trees=4&leaves=50"}) {
    const Scene still = make_procedural(name);
    Renderer renderer;
    renderer.render(still, options);
    for (const float aside : {8.0f, -8.0f}) {
      Scene moved = still;
      for (Instance& instance : moved.instances) instance.to_world[3][0] += aside;
      const RenderResult seen = renderer.render(moved, options), fresh = render(moved, options);
      EXPECT_GT(mean_of(fresh, "A"), 0.01) << name << " is in the picture";
      for (const char* channel : {"A", "P.X", "ao.R"})
        EXPECT_EQ(mean_of(seen, channel), mean_of(fresh, channel)) << name << ": " << channel;
    }
  }
}

Scene coloured_cards(float size) {
  Scene scene = scene_test::textured_cards();
  ColorTexture colors;
  colors.width = colors.height = 64;
  for (int i = 0; i < 3 * 64 * 64; ++i)
    colors.rgb.push_back(i / 3 % 64 / 8 % 2 == i / 3 / 64 / 8 % 2 ? 250 : 10);
  scene.color_textures = {colors};
  for (Material& material : scene.materials) material.color_texture = 0;
  scene.materials[0].alpha_mode = AlphaMode::opaque;  // has texels of colours alone
  scene.materials[0].alpha_texture = -1;
  for (V3f& p : scene.meshes[0].positions) p *= size;
  return scene;
}

// Textures are averaged over footprints by the size of their texels, which grows with the object.
TEST(Renderer, TexturesOfWhatGrowsAreThoseOfFreshBvhs) {
  RenderOptions options = small_picture(Estimator::prefiltered, 64, 16);
  options.look = LookAt{V3f(0, 1, 4), V3f(0, 0.5f, 0), V3f(0, 1, 0)};
  options.light = false;
  Renderer renderer;
  for (const float size : {0.02f, 0.021f}) renderer.render(coloured_cards(size), options);
  const Scene grown = coloured_cards(1);
  const RenderResult refitted = renderer.render(grown, options), fresh = render(grown, options);
  EXPECT_EQ(refitted.statistics.refit.objects_refitted, 1u);
  for (const char* channel : {"albedo.R", "A", "ao.R"}) {
    const auto &found = refitted.film.find(channel)->pixels,
               &expected = fresh.film.find(channel)->pixels;
    double squares = 0;
    for (std::size_t p = 0; p < found.size(); ++p)
      squares += (found[p] - expected[p]) * (found[p] - expected[p]);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(found.size())), 0.01) << channel;
  }
}

TEST(Renderer, GoesOnAfterAnError) {
  const Scene still = tree(500);
  const RenderOptions options = small_picture(Estimator::prefiltered);
  RenderOptions wrong = options;
  wrong.device = "none of that name";
  Renderer renderer;
  const double before = mean_ao(renderer.render(still, options));
  EXPECT_THROW(renderer.render(still, wrong), Error);
  EXPECT_EQ(mean_ao(renderer.render(still, options)), before);
}

TEST(Renderer, AnotherSceneIsAnotherPicture) {
  const RenderOptions options = small_picture(Estimator::prefiltered);
  Renderer renderer;
  renderer.render(tree(500), options);
  const Scene cloud = make_procedural("scene:cloud?leaves=500");
  EXPECT_EQ(mean_ao(renderer.render(cloud, options)), mean_ao(render(cloud, options)));
}

// Triangles without an area are dropped before the BVH is built, so the BVH has fewer triangles and
// cannot be refitted.
TEST(Renderer, ALeafThatLosesItsAreaHasItsObjectBuiltAnew) {
  const Scene still = tree(500);
  const RenderOptions options = small_picture(Estimator::exact, 16, 4);
  Renderer renderer;
  renderer.render(still, options);
  renderer.render(swayed(still, 0.1f), options);
  Scene moved = swayed(still, 0.2f);
  std::vector<V3f>& positions = moved.meshes[0].positions;
  for (std::size_t v = positions.size() - 4; v < positions.size(); ++v)
    positions[v] = positions.back();
  const RenderResult dropped = renderer.render(moved, options);
  EXPECT_EQ(dropped.statistics.refit.objects_rebuilt, 1u);
  EXPECT_EQ(mean_ao(dropped), mean_ao(render(moved, options)));
}

/// The frame rate of films: the fastest leaves turn by about 5 degrees from frame to frame.
constexpr float kFrameSeconds = 1.0f / 24;

/// Mean occlusion at random points in the tree's box. Half of the normals point up, half down.
class CrownOcclusion {
 public:
  explicit CrownOcclusion(const Box3f& box) {
    scene_test::Points points(1);
    for (int i = 0; i < 512; ++i) {
      points_.push_back(box.center() + points.in_cube(0.4f) * (box.max - box.min));
      normals_.emplace_back(0.0f, i % 2 ? 1.0f : -1.0f, 0.0f);
    }
  }
  [[nodiscard]] double mean(const DeviceScene& scene, Estimator estimator,
                            std::uint32_t seeds = 1) const {
    OcclusionOptions options;
    options.rays = 128;
    options.estimator = estimator;
    options.footprint = kDefaultFootprint;  // of pictures, which are what moves
    double sum = 0;
    for (options.seed = 0; options.seed < seeds; ++options.seed) {
      const auto values = occlusion(scene_test::device(), scene, points_, normals_, options);
      sum = std::accumulate(values.begin(), values.end(), sum);
    }
    return sum / static_cast<double>(seeds * points_.size());
  }

 private:
  std::vector<V3f> points_, normals_;
};

// The step of the mean occlusion from frame to frame must not be much larger than with the exact
// estimator and the same rays, where the motion of the leaves alone causes the step.
TEST(SwayingTree, AHundredFramesDontPop) {
  const Scene still = tree(5000);
  UpdatableBvh updatable(still);
  const CrownOcclusion crown(updatable.bvh().bounds);
  DeviceScene on_device = upload(scene_test::device(), still, updatable.bvh());
  double last_exact = 0, last = 0, max_prefiltered = 0, max_exact = 0, max_bias = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const Scene moved = swayed(still, kFrameSeconds * static_cast<float>(frame));
    update(scene_test::device(), on_device, updatable, moved);
    const double exact = crown.mean(on_device, Estimator::exact);
    const double prefiltered = crown.mean(on_device, Estimator::prefiltered);
    if (frame > 0) {
      max_prefiltered = std::max(max_prefiltered, std::fabs(prefiltered - last));
      max_exact = std::max(max_exact, std::fabs(exact - last_exact));
    }
    max_bias = std::max(max_bias, std::fabs(prefiltered - exact));
    last_exact = exact;
    last = prefiltered;
  }
  std::printf("largest step of mean AO exact %.5f, prefiltered %.5f; largest bias %.5f\n",
              max_exact, max_prefiltered, max_bias);
  EXPECT_LT(max_prefiltered, max_exact + 0.001);
  EXPECT_LT(max_bias, 0.01);
}

TEST(SwayingTree, OcclusionInARefittedBvhIsThatInAFreshOne) {
  for (const char* spec : {"scene:tree", "scene:tree?opacity=0.3", "scene:cloud"}) {
    const Scene still = make_procedural(spec);
    UpdatableBvh updatable(still);
    for (const float time : {0.5f, 2.0f}) {
      const Scene moved = swayed(still, time);
      updatable.update(moved);
      const scene_test::SceneOnDevice fresh(moved);
      const CrownOcclusion crown(fresh.bvh.bounds);
      const DeviceScene on_device = upload(scene_test::device(), moved, updatable.bvh());
      const double exact = crown.mean(fresh.uploaded, Estimator::exact),
                   exact_refitted = crown.mean(on_device, Estimator::exact),
                   built = crown.mean(fresh.uploaded, Estimator::prefiltered),
                   refitted = crown.mean(on_device, Estimator::prefiltered);
      std::printf("%s at %.1f s: AO exact %.5f, prefiltered fresh %+.5f, refitted %+.5f\n", spec,
                  time, exact, built - exact, refitted - exact);
      EXPECT_NEAR(exact_refitted, exact, 0.0005);
      EXPECT_NEAR(refitted, built, 0.003);
    }
  }
}

/// Compares the occlusion in a refitted BVH with that in a newly built one.
void expect_same_occlusion(const Scene& still, const Scene& moved) {
  UpdatableBvh updatable(still);
  ASSERT_EQ(updatable.update(moved).objects_refitted, 1u);
  const scene_test::SceneOnDevice fresh(moved);
  const CrownOcclusion crown(fresh.bvh.bounds);
  const DeviceScene on_device = upload(scene_test::device(), moved, updatable.bvh());
  // The rays of a single seed change the difference by about 0.0005.
  constexpr std::uint32_t kSeeds = 4;
  EXPECT_NEAR(crown.mean(on_device, Estimator::prefiltered, kSeeds),
              crown.mean(fresh.uploaded, Estimator::prefiltered, kSeeds), 0.003);
}

// No part moves rigidly here, so refitting computes all opacities anew.
TEST(SwayingTree, OcclusionInASquashedTreeIsThatInAFreshBvh) {
  const Scene still = tree(10000);
  Scene moved = still;
  for (V3f& p : moved.meshes[0].positions) p.y *= 0.4f;
  expect_same_occlusion(still, moved);
}

// All parts move rigidly but turn relative to the axes: level leaves become upright.
TEST(SwayingTree, OcclusionInAFallenTreeIsThatInAFreshBvh) {
  const Scene still = tree(10000);
  for (const float angle : {0.4f, 0.8f, 1.57f}) {
    Scene moved = still;
    for (V3f& p : moved.meshes[0].positions) p = motion::turned(p, V3f(0, 0, 1), angle);
    expect_same_occlusion(still, moved);
  }
}

std::size_t resident_bytes() {
  malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * 4096;
}

/// Runs `frame` 100 times, then 1,000 times more. In the latter memory may grow by at most 1 %.
template <class Frame>
void expect_flat_memory(const Frame& frame) {
  DAPPLE_SKIP_WITH_SANITIZER();
  for (int i = 0; i < 100; ++i) frame(i);
  const auto before = static_cast<double>(resident_bytes());
  for (int i = 100; i < 1100; ++i) frame(i);
  const auto after = static_cast<double>(resident_bytes());
  std::printf("%.1f MB before, %.1f MB after 1,000\n", before * 1e-6, after * 1e-6);
  EXPECT_LT(after, 1.01 * before);
}

TEST(FlatMemory, AThousandFramesTakeNoMoreMemory) {
  const Scene still = tree(300);
  const RenderOptions options = small_picture(Estimator::prefiltered, 8, 1);
  Renderer renderer;
  expect_flat_memory([&](int i) {
    renderer.render(swayed(still, kFrameSeconds * static_cast<float>(i)), options);
  });
}

// Each scene differs from the previous one, so that the renderer builds a new BVH each time.
TEST(FlatMemory, AThousandScenesTakeNoMoreMemory) {
  const Scene scenes[] = {tree(300), make_procedural("scene:cloud?leaves=300"), tree(200)};
  const RenderOptions options = small_picture(Estimator::prefiltered, 8, 1);
  Renderer renderer;
  expect_flat_memory([&](int i) { renderer.render(scenes[i % 3], options); });
}

}  // namespace
}  // namespace dapple
