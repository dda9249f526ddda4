// How many rays a pilot takes to measure a bias: it keeps all of them in memory. It writes each to
// the device once to trace it exactly, and little else, so bytes that are written count rays.
#include "render/bias/bias_pilot.hpp"

#include <gtest/gtest.h>

#include "camera/camera_splitting.hpp"
#include "support/failing_opencl.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

/// Rays of each layer that the pilot is asked for.
constexpr std::size_t kAsked = 1u << 14;

/// A cube in front of many lights, which are all the same.
Scene cube_with_lights(std::size_t count) {
  Scene scene = make_procedural("scene:cube?divisions=1");
  std::vector<std::string> notes;
  const Light light = key_light(scene, choose_view(scene, RenderOptions(), notes).camera);
  scene.lights.assign(count, light);
  return scene;
}

RenderOptions square_picture() {
  RenderOptions options;
  options.width = options.height = 256;
  options.camera_splitting = 1;
  return options;
}

/// Rays of all layers that a pilot takes if it is asked for `asked` of each.
double rays_taken(const Scene& scene, const RenderOptions& options, std::size_t asked) {
  const SceneBvh bvh = build_bvh(scene);
  const DeviceScene uploaded = upload(scene_test::device(), scene, bvh);
  const DeviceBuffers& buffers = *uploaded.buffers;
  std::vector<std::string> notes;
  const View view = choose_view(scene, options, notes);
  const RenderOptions sampled = by_sample(options);
  const FilmLayout layout(view.crop, sampled,
                          film_scales(view, buffers.bounds, buffers.light_records), scene.lights);
  BiasPilot pilot(scene_test::device().context(), buffers, view, sampled, layout,
                  camera_params(view, sampled, buffers.bounds));
  const std::size_t before = opencl_test::written_bytes();
  pilot.grow(asked);
  EXPECT_FALSE(pilot.is_complete()) << "a small picture bounds the rays, too";
  return static_cast<double>(opencl_test::written_bytes() - before) / sizeof(Ray);
}

TEST(BiasPilot, ManyRaysOfAPointAddNone) {
  for (const bool ao : {true, false}) {
    SCOPED_TRACE(ao ? "ao" : "light");
    const Scene scene = cube_with_lights(ao ? 0 : 1);
    const auto taken = [&](int rays) {
      RenderOptions options = square_picture();
      options.ao = ao;
      options.ao_rays = options.light_rays = rays;
      return rays_taken(scene, options, kAsked);
    };
    const double some = taken(16);
    EXPECT_GE(some, kAsked);
    EXPECT_LT(some, 8 * kAsked);
    EXPECT_NEAR(taken(4096), some, 1);
  }
}

// Each takes 56 bytes on the host. Without a bound those of so many layers take 2 GB at the first
// demand of choose_footprint(), and 60 GB at the last one.
TEST(FlatMemory, APilotKeepsAsManyRaysHoweverManyLightsThereAre) {
  constexpr double kBound = 1u << 24;
  RenderOptions options = square_picture();
  options.ao_rays = 1;
  const double taken = rays_taken(cube_with_lights(1023), options, 2 * kAsked);
  EXPECT_GE(taken, kBound) << "1,024 layers of 16,384 rays";
  EXPECT_LT(taken, 1.25 * kBound);
}

}  // namespace
}  // namespace dapple
