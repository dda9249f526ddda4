// The footprint that dapple chooses by itself, where the default has too much bias.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

constexpr float kDefault = 4;

/// A field of grass, whose bias is 0.008 with the default footprint.
Scene grass() { return make_procedural("scene:grass?leaves=60000&length=30"); }

/// A picture of just enough samples for a pilot, of which a few pixels are rendered: the pilot is
/// of the whole picture.
RenderOptions part_of_picture(int row) {
  RenderOptions options;
  options.width = options.height = 256;
  options.spp = 16;
  options.light = options.albedo = false;
  options.crop = PixelRect{96, row, 159, row + 15};
  return options;
}

float footprint_of(const RenderOptions& options, const RenderControl& control = {}) {
  return render(grass(), options, control).statistics.footprint;
}

TEST(FootprintPilot, ASmallerFootprintIsTakenWhereTheDefaultHasTooMuchBias) {
  const RenderOptions options = part_of_picture(200);
  const RenderResult result = render(grass(), options);
  const float chosen = result.statistics.footprint;
  EXPECT_LT(chosen, kDefault);
  ASSERT_FALSE(result.statistics.notes.empty());
  EXPECT_NE(result.statistics.notes[0].find("in place of footprint 4, whose bias is about -0.00"),
            std::string::npos)
      << result.statistics.notes[0];
  RenderOptions given = options;
  given.footprint = chosen;
  given.max_bias = 0.0f;
  const Film same = render(grass(), given).film;
  for (const Plane& plane : result.film.planes)
    EXPECT_EQ(same.find(plane.channel)->pixels, plane.pixels) << plane.channel;
}

TEST(FootprintPilot, ALimitOfZeroAndFewSamplesKeepTheFootprint) {
  RenderOptions options = part_of_picture(200);
  options.max_bias = 0.0f;
  EXPECT_EQ(footprint_of(options), kDefault);
  options.max_bias.reset();
  options.spp = 15;
  EXPECT_EQ(footprint_of(options), kDefault);
}

TEST(FootprintPilot, ItIsForPicturesThatAreNeitherSmallNorHuge) {
  RenderOptions options = part_of_picture(200);
  EXPECT_TRUE(chooses_footprint(options));
  options.width = 255;
  EXPECT_FALSE(chooses_footprint(options));
  options.width = options.height = 1 << 14;
  EXPECT_FALSE(chooses_footprint(options));
  options.height /= 2;
  EXPECT_TRUE(chooses_footprint(options));
  options.target_rmse = 0.01f;
  EXPECT_FALSE(chooses_footprint(options));
}

// Its queues would be of 6 GB.
TEST(FootprintPilot, ManyRaysOfASampleAreTracedInParts) {
  RenderOptions options = part_of_picture(200);
  options.crop = PixelRect{124, 200, 125, 201};
  options.ao_rays = 4096;
  options.camera_splitting = 1;
  const RenderStatistics statistics = render(grass(), options).statistics;
  EXPECT_GT(statistics.pass_seconds.at("bias pilot"), 0);
}

// The second crop shows little but sky.
TEST(FootprintPilot, CropsAndShardsTakeWhatTheWholePictureTakes) {
  const RenderOptions options = part_of_picture(200);
  const float chosen = footprint_of(options);
  EXPECT_EQ(footprint_of(part_of_picture(2)), chosen);
  const std::filesystem::path part =
      std::filesystem::temp_directory_path() / ("dapple_pilot_" + std::to_string(getpid()));
  RenderControl control;
  control.part = part.string();
  RenderOptions shard = options;
  shard.shard = {2, 4};
  EXPECT_EQ(footprint_of(shard, control), chosen);
  std::filesystem::remove(part);
}

TEST(FootprintPilot, AResumedPictureKeepsTheFootprint) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("dapple_pilot_resume_" + std::to_string(getpid()));
  RenderControl first, second;
  first.checkpoint = second.resume = path.string();
  RenderOptions options = part_of_picture(200);
  options.spp = 8;
  EXPECT_EQ(footprint_of(options, first), kDefault);
  options.spp = 16;
  EXPECT_EQ(footprint_of(options, second), kDefault);
  std::filesystem::remove(path);
}

TEST(FootprintPilot, ARenderThatIsResumedWithAnotherFootprintSaysThatItKeepsTheFirst) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("dapple_pilot_note_" + std::to_string(getpid()));
  RenderControl first, second;
  first.checkpoint = second.resume = path.string();
  RenderOptions options = part_of_picture(200);
  const float chosen = footprint_of(options, first);
  ASSERT_LT(chosen, kDefault);
  const auto says_so = [&] {
    const RenderStatistics statistics = render(grass(), options, second).statistics;
    EXPECT_EQ(statistics.footprint, chosen);
    return std::any_of(statistics.notes.begin(), statistics.notes.end(), [](const auto& note) {
      return note.find(" goes on with the footprint that it began with, ") != std::string::npos &&
             note.ends_with(", not 4");
    });
  };
  EXPECT_FALSE(says_so());
  options.max_bias = 0.0f;
  EXPECT_TRUE(says_so());
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace dapple
