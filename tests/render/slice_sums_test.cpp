// Pixels whose samples are traced in several slices: no slice is lost, of fronts, backs and shards.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/picture.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using scene_test::device;
using scene_test::SceneOnDevice;

constexpr int kPixels = 16, kSamples = 256;

/// Sums of a picture in which every camera ray hits a wall, with slices of `slice` samples, from
/// sample `first` on.
struct WallSums {
  std::vector<std::int64_t> sums;
  FilmLayout layout;
  [[nodiscard]] std::int64_t of(std::uint32_t plane, std::size_t pixel) const {
    return sums[std::size_t{plane} * kPixels + pixel];
  }
};

WallSums trace_wall(std::uint32_t slice, std::uint32_t first) {
  Scene scene;
  scene.materials.push_back(scene_test::material_of(1));
  scene_test::place(scene, scene_test::square_mesh(9, 0, 1, 0));
  const SceneOnDevice wall(std::move(scene));
  RenderOptions options;
  options.width = options.height = 4;
  options.spp = static_cast<int>(first) + kSamples;
  options.back = true;
  options.albedo = false;
  options.back_every = 16;
  options.report_bias = 0;
  options.camera_splitting = options.ao_rays = 1;
  options.look = LookAt{{0, 5, 0}, {0, 0, 0}, {0, 0, -1}};
  std::vector<std::string> notes;
  const View view = choose_view(wall.scene, options, notes);
  const FilmLayout layout(view.crop, options,
                          film_scales(view, wall.bvh.bounds, wall.uploaded.buffers->light_records),
                          wall.scene.lights);
  TraceState from;
  from.slice_samples = slice;
  from.first_sample = first;
  const TracedPicture picture =
      trace_picture(device(), wall.uploaded, view, options, layout, {}, std::move(from));
  const auto sums = picture.sums.values<std::int64_t>();
  return {{sums.begin(), sums.end()}, layout};
}

TEST(SliceSums, EverySliceOfAPixelCounts) {
  for (const std::uint32_t slice : {1u << 20, 2048u, 64u})
    for (const std::uint32_t first : {0u, 512u}) {
      const WallSums wall = trace_wall(slice, first);
      for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
        SCOPED_TRACE(testing::Message() << slice << ", from " << first << ", pixel " << pixel);
        EXPECT_EQ(wall.of(DAPPLE_PLANE_HITS, pixel), kSamples);
        const std::uint32_t backs = wall.layout.back_samples;
        EXPECT_EQ(wall.of(backs + DAPPLE_PLANE_BACK_CHOSEN, pixel), kSamples / 16);
        EXPECT_EQ(wall.of(backs + DAPPLE_PLANE_BACK_HITS, pixel), kSamples / 16);
        EXPECT_NEAR(static_cast<double>(wall.of(wall.layout.ao, pixel)),
                    kSamples * double{wall.layout.unit_scale},
                    0.001 * double{wall.layout.unit_scale});
        EXPECT_NEAR(static_cast<double>(wall.of(wall.layout.back_ao, pixel)),
                    kSamples / 16 * double{wall.layout.unit_scale},
                    0.001 * double{wall.layout.unit_scale});
      }
    }
}

}  // namespace
}  // namespace dapple
