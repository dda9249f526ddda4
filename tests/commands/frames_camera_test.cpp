// The camera that dapple render adds for a sequence: its note has the options with which a later
// sequence shows what this one would have shown.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include "dapple/film.hpp"
#include "support/files/gltf_builder.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using program_test::Outcome;

class FramesCamera : public program_test::ProgramRun {
 protected:
  /// Renders a tree that sways in the wind, whose size is another in each frame.
  [[nodiscard]] Outcome tree(const std::string& options) const {
    return dapple("render 'scene:tree?leaves=200&wind=1' --spp 4 --passes ao " + options);
  }

  /// The largest difference of their depths, as a part of the depth. Infinite: one pixel shows
  /// something in one picture only.
  [[nodiscard]] double difference(const char* a, const char* b) const {
    const Film first = read_exr(path(a)), second = read_exr(path(b));
    const std::vector<float>&x = first.find("Z")->pixels, &y = second.find("Z")->pixels;
    EXPECT_EQ(x.size(), y.size());
    double largest = 0;
    for (std::size_t p = 0; p < x.size(); ++p) {
      if (std::isinf(x[p]) && std::isinf(y[p])) continue;
      if (std::isinf(x[p]) || std::isinf(y[p])) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, double{std::abs(x[p] - y[p])} / double{x[p]});
    }
    return largest;
  }
};

/// The options that a note tells; empty: it tells none.
std::string camera_options(const std::string& notes) {
  static const std::regex kOptions(
      "note: all frames have the same camera; a later sequence has it with "
      "(--look-from \\S+ --look-at \\S+ --fov \\S+( --focus-distance \\S+)?)\n");
  std::smatch found;
  return std::regex_search(notes, found, kOptions) ? found[1].str() : "";
}

// Coordinates are rounded to floats: depths of what rays graze differ more than others.
TEST_F(FramesCamera, TheNotedOptionsShowALaterFrameAsTheSequenceDid) {
  for (const std::string size : {"--width 16 --height 9 ", "--width 9 --height 16 "}) {
    SCOPED_TRACE(size);
    const Outcome whole = tree(size + "--frames 0-2:2 --fps 1 -o whole.#.exr");
    ASSERT_EQ(whole.code, 0) << whole.err;
    const std::string options = camera_options(whole.err);
    ASSERT_NE(options, "") << whole.err;
    ASSERT_EQ(tree(size + "--frames 2-2 --fps 1 -q -o later.#.exr " + options).code, 0);
    ASSERT_EQ(tree(size + "--frames 2-2 --fps 1 -q -o own.#.exr").code, 0);
    EXPECT_LT(difference("whole.2.exr", "later.2.exr"), 1e-3);
    EXPECT_GT(difference("whole.2.exr", "own.2.exr"), 1e-2) << "its own camera is another";
  }
}

// The lens is wide: focused elsewhere, other leaves are seen.
TEST_F(FramesCamera, OfALensHasItsFocusDistanceInTheNotedOptions) {
  const std::string lens = "--width 16 --height 9 --fps 1 --aperture 0.5 ";
  const Outcome whole = tree(lens + "--frames 0-2:2 -o whole.#.exr");
  ASSERT_EQ(whole.code, 0) << whole.err;
  const std::string options = camera_options(whole.err);
  const std::size_t focus = options.find(" --focus-distance ");
  ASSERT_NE(focus, std::string::npos) << whole.err;
  ASSERT_EQ(tree(lens + "--frames 2-2 -q -o later.#.exr " + options).code, 0);
  ASSERT_EQ(tree(lens + "--frames 2-2 -q -o look.#.exr " + options.substr(0, focus)).code, 0);
  EXPECT_LT(difference("whole.2.exr", "later.2.exr"), 1e-3);
  EXPECT_GT(difference("whole.2.exr", "look.2.exr"), 1e-2) << "it focuses on --look-at";
  const Outcome given = tree(lens + "--frames 0-0 --focus-distance 3 -o given.#.exr");
  EXPECT_EQ(given.code, 0) << given.err;
  EXPECT_FALSE(contains(given.err, "--focus-distance")) << given.err;
}

/// A wall of 1 m that faces +Z at `at`, and grows from nothing within a second.
test::GltfBuilder growing_wall(const std::vector<float>& at) {
  test::GltfBuilder file;
  file.add_mesh({{"attributes",
                  {{"POSITION",
                    file.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0})}}}});
  file.doc["nodes"][0]["translation"] = at;
  const int times = file.add_accessor(std::vector<float>{0, 1}, test::kFloat, "SCALAR");
  for (const char* end : {"min", "max"})
    file.doc["accessors"][times][end] = {end[1] == 'i' ? 0 : 1};
  const int scales = file.add_accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, test::kFloat, "VEC3");
  file.add("animations",
           {{"samplers", {{{"input", times}, {"output", scales}}}},
            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}}}});
  return file;
}

// Its camera is that of the wall when it is grown, and repeated 40 km from the origin, too.
TEST_F(FramesCamera, OfWhatGrowsFromNothingIsThatOfItsEnd) {
  for (const float far : {0.0f, 30000.0f}) {
    SCOPED_TRACE(far);
    write("wall.glb", growing_wall({far, 0, far}).glb());
    const std::string wall = "render wall.glb --spp 4 --passes ao --width 16 --height 9 --fps 1 ";
    const Outcome whole = dapple(wall + "--frames 0-1 -o whole.#.exr");
    ASSERT_EQ(whole.code, 0) << whole.err;
    ASSERT_EQ(dapple(wall + "--frames 1-1 -q -o own.#.exr").code, 0);
    EXPECT_LT(difference("whole.1.exr", "own.1.exr"), 1e-3);
    const std::string again = "--frames 1-1 -q -o later.#.exr " + camera_options(whole.err);
    ASSERT_EQ(dapple(wall + again).code, 0);
    EXPECT_LT(difference("whole.1.exr", "later.1.exr"), 1e-2);
    const Film empty = read_exr(path("whole.0.exr"));
    for (const float a : empty.find("A")->pixels) EXPECT_EQ(a, 0);
  }
}

TEST_F(FramesCamera, OnlySequencesWhoseCameraIsAddedHaveTheNote) {
  const std::string size = "--width 8 --height 8 ";
  EXPECT_NE(camera_options(tree(size + "--frames 1-2 -o a.#.exr").err), "");
  for (const char* options : {"-o a.exr", "--frame 1 -o a.exr",
                              "--frames 1-2 -o a.#.exr --look-from 0,2,9 --look-at 0,2,0"}) {
    const Outcome run = tree(size + options);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(camera_options(run.err), "") << options;
  }
  const Outcome own =
      dapple("render 'scene:grass?leaves=100' " + size + "--spp 1 --frames 1-2 -o a.#.exr");
  EXPECT_EQ(own.code, 0) << own.err;
  EXPECT_EQ(camera_options(own.err), "") << "the grass has a camera";
}

}  // namespace
}  // namespace dapple
