// The same command gives the same bits: on every run, with any number of threads of device and BVH
// builder, in the whole picture and in a crop. Another seed gives another picture.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "support/same_bits.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

// Tests with a temporary folder for the program's pictures, which is removed afterwards.
class Determinism : public ::testing::Test {
 protected:
  Determinism()
      : folder_(fs::temp_directory_path() / ("dapple_determinism_" + std::to_string(getpid()))) {
    fs::create_directory(folder_);
  }
  ~Determinism() override { fs::remove_all(folder_); }

  // Renders a small image in a new process and returns its path; `environment` as "NAME=value ".
  [[nodiscard]] std::string rendered(const std::string& name, const std::string& arguments = "",
                                     const std::string& environment = "") const {
    const std::string path = (folder_ / name).string();
    const std::string command = environment + "'" + DAPPLE_PROGRAM + "' render '" + scene_ +
                                "' --width 64 --height 48 --spp 4 -q -o '" + path + "' " +
                                arguments;
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return path;
  }

  std::string scene_ = "scene:demo";
  fs::path folder_;
};

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(Determinism, TheProgramWritesTheSameBytesAgainAndWithAnyNumberOfDeviceThreads) {
  const std::string first = bytes_of(rendered("first.exr"));
  ASSERT_GT(first.size(), 10000u);
  EXPECT_EQ(bytes_of(rendered("again.exr")), first);
  EXPECT_EQ(bytes_of(rendered("one.exr", "", "POCL_MAX_PTHREAD_COUNT=1 ")), first);
  EXPECT_EQ(bytes_of(rendered("two.exr", "", "POCL_MAX_PTHREAD_COUNT=2 ")), first);
}

TEST_F(Determinism, TheProgramWritesTheSameBytesWithATarget) {
  for (const std::string adaptive : {"--target-error 0.05", "--target-rmse 0.02"}) {
    const std::string first = bytes_of(rendered("first.exr", adaptive));
    EXPECT_EQ(bytes_of(rendered("one.exr", adaptive, "POCL_MAX_PTHREAD_COUNT=1 ")), first);
    EXPECT_EQ(bytes_of(rendered("two.exr", adaptive, "POCL_MAX_PTHREAD_COUNT=2 ")), first);
  }
}

TEST_F(Determinism, TheProgramWritesTheSameBytesWithAnOpenShutterAndALens) {
  scene_ = "scene:tree?leaves=2000&wind=1";
  const std::string blurred = "--frame 1 --shutter -0.5,0.5 --motion-samples 3 --aperture 0.1";
  const std::string first = bytes_of(rendered("first.exr", blurred));
  EXPECT_NE(bytes_of(rendered("sharp.exr", "--frame 1")), first);
  EXPECT_EQ(bytes_of(rendered("one.exr", blurred, "POCL_MAX_PTHREAD_COUNT=1 ")), first);
  EXPECT_EQ(bytes_of(rendered("two.exr", blurred, "POCL_MAX_PTHREAD_COUNT=2 ")), first);
}

TEST_F(Determinism, ALightKeepsItsNoiseWhenAnotherIsSwitchedOff) {
  const auto light_b = [&](const std::string& enabled) {
    const fs::path path = folder_ / "lights.json";
    std::ofstream(path) << R"({"lights": [{"type": "dome", "name": "a", "enabled": )" << enabled
                        << R"(}, {"type": "dome", "name": "b"}]})";
    const Film film = read_exr(rendered("lit.exr", "--lights '" + path.string() + "'"));
    EXPECT_EQ(film.find("light.a.R") != nullptr, enabled == "true");
    return film.find("light.b.R")->pixels;
  };
  EXPECT_TRUE(same_bits(light_b("true"), light_b("false")));
}

TEST_F(Determinism, AnotherSeedGivesOtherNoiseInEveryPass) {
  const Film a = read_exr(rendered("a.exr"));
  const Film b = read_exr(rendered("b.exr", "--seed 1"));
  for (const char* channel : {"ao.R", "bent.X", "light.sun.R", "light.sky.B", "P.X", "Z"}) {
    ASSERT_NE(a.find(channel), nullptr) << channel;
    EXPECT_FALSE(same_bits(a.find(channel)->pixels, b.find(channel)->pixels)) << channel;
  }
}

std::vector<float> cropped(const Film& film, const Plane& plane, const PixelRect& crop) {
  std::vector<float> pixels;
  for (int y = crop.y0; y <= crop.y1; ++y) {
    const auto row = plane.pixels.begin() + y * film.width;
    pixels.insert(pixels.end(), row + crop.x0, row + crop.x1 + 1);
  }
  return pixels;
}

// A packet of a single ray gives the same result as a packet of many.
TEST(Crop, OfASinglePixelAndSampleEqualsThatOfTheWholePicture) {
  Scene scene = make_procedural("scene:tree?leaves=3000");
  RenderOptions options;
  options.width = 16;
  options.height = 16;
  options.spp = 1;
  const Film whole = render(scene, options).film;
  int hits = 0;
  for (int x = 5; x < 11; ++x) {
    options.crop = PixelRect{x, 7, x, 7};
    const Film part = render(scene, options).film;
    hits += part.find("A")->pixels[0] > 0;
    for (const char* channel : {"ao.R", "bent.X", "light.sun.R", "light.sky.B", "Z"}) {
      EXPECT_TRUE(same_bits(part.find(channel)->pixels,
                            cropped(whole, *whole.find(channel), *options.crop)))
          << channel << " at " << x;
    }
  }
  EXPECT_GT(hits, 2);
}

TEST(Crop, EqualsTheSamePartOfTheWholePictureBitForBit) {
  Scene scene = make_procedural("scene:tree?leaves=3000");
  RenderOptions options;
  options.width = 61;
  options.height = 47;
  options.spp = 5;
  options.ao_rays = 2;
  options.ground = true;
  const Film whole = render(scene, options).film;
  options.crop = PixelRect{13, 9, 50, 40};
  const Film part = render(scene, options).film;
  EXPECT_EQ(part.width, 61);
  EXPECT_EQ(part.data_window, *options.crop);
  ASSERT_EQ(part.planes.size(), whole.planes.size());
  for (const Plane& plane : whole.planes) {
    const Plane* found = part.find(plane.channel);
    ASSERT_NE(found, nullptr) << plane.channel;
    // R, G, B are relative to the largest irradiance of the rendered pixels, which may be outside
    // of a crop.
    if (plane.channel == "R" || plane.channel == "G" || plane.channel == "B") continue;
    EXPECT_TRUE(same_bits(found->pixels, cropped(whole, plane, *options.crop))) << plane.channel;
  }
  options.light = false;
  const Film ao_part = render(scene, options).film;
  options.crop.reset();
  const Film ao_whole = render(scene, options).film;
  for (const Plane& plane : ao_whole.planes) {
    EXPECT_TRUE(same_bits(ao_part.find(plane.channel)->pixels,
                          cropped(ao_whole, plane, PixelRect{13, 9, 50, 40})))
        << plane.channel;
  }
}

TEST(Bvh, IsTheSameByteForByteWhateverTheThreads) {
  for (const char* name : {"scene:tree?leaves=20000", "scene:forest?trees=40&leaves=300"}) {
    const Scene scene = make_procedural(name);
    const auto built = [&](std::size_t threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return build_bvh(scene);
    };
    const SceneBvh one = built(1), two = built(2), four = built(4);
    for (const SceneBvh* other : {&two, &four}) {
      EXPECT_TRUE(same_bits(one.nodes, other->nodes)) << name;
      EXPECT_TRUE(same_bits(one.blocks, other->blocks)) << name;
      EXPECT_TRUE(same_bits(one.instances, other->instances)) << name;
      EXPECT_EQ(one.root, other->root);
      EXPECT_EQ(one.statistics.root_opacity[1], other->statistics.root_opacity[1]) << name;
    }
  }
}

}  // namespace
}  // namespace dapple
