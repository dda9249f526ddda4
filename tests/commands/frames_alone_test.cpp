// Frames that are rendered one by one, as on a farm: the options that notes name make them alike,
// where each would choose its own ground or focus distance.
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "dapple/film.hpp"
#include "support/files/gltf_builder.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using program_test::Outcome;

class FramesAlone : public program_test::ProgramRun {
 protected:
  /// Writes climb.glb: a triangle that moves up at 1 m/s from 0 s to 1 s.
  void SetUp() override {
    test::GltfBuilder b = test::one_triangle();
    b.add_movement(0, {0, 1}, {0, 0, 0, 0, 1, 0});
    write("climb.glb", b.glb());
  }
  [[nodiscard]] Outcome climb(const std::string& options) const {
    return dapple("render climb.glb --width 16 --height 16 --spp 4 --fps 1 --passes ao " + options);
  }
  /// The height of the ground in the lowest row of a picture, metres.
  [[nodiscard]] float ground(const char* name) const {
    return read_exr(path(name)).find("P.Y")->pixels.back();
  }
};

/// The options after `begin` in the notes; empty: there are none.
std::string noted(const std::string& notes, const std::string& begin) {
  std::smatch found;
  const std::regex line("note: [^\n]*" + begin + "(--[^\n]*)\n");
  return std::regex_search(notes, found, line) ? found[1].str() : "";
}

TEST_F(FramesAlone, HaveTheGroundOfTheSequenceAtTheNotedHeight) {
  const std::string camera = " --look-from 0,3,6 --look-at 0,0,0 ";
  const Outcome both = climb("--frames 0-1 --ground -o a.#.exr" + camera);
  ASSERT_EQ(both.code, 0) << both.err;
  const std::string options = noted(both.err, "a later sequence has it with ");
  EXPECT_TRUE(options.starts_with("--ground --ground-height=")) << both.err;
  const Outcome own = climb("--frame 1 --ground -o own.exr" + camera);
  EXPECT_NEAR(ground("own.exr"), 1, 1e-3) << "it is under the triangle, which has risen";
  EXPECT_NE(noted(own.err, "other frames have it with "), "") << own.err;
  for (const std::string frame :
       {"--frame 1 -o b.exr", "--frames 1-1 -o b.exr#", "--frame 1 --shutter 0,0.1 -o b.exr"}) {
    SCOPED_TRACE(frame);
    const Outcome alone = climb(frame + " " + options + camera);
    ASSERT_EQ(alone.code, 0) << alone.err;
    EXPECT_EQ(noted(alone.err, "ground.* with "), "") << alone.err;
    EXPECT_NEAR(ground(frame.ends_with('#') ? "b.exr1" : "b.exr"), ground("a.1.exr"), 1e-5);
  }
}

TEST_F(FramesAlone, AGroundIsWhereItIsPut) {
  const std::string camera = " --look-from 0,3,6 --look-at 0,0,0 -o a.exr";
  for (const char* height : {"-0.5", "0.25"}) {
    const Outcome run = climb(std::string("--frame 0 --ground --ground-height=") + height + camera);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_NEAR(ground("a.exr"), std::stof(height), 1e-5);
    EXPECT_EQ(noted(run.err, "ground.* with "), "") << run.err;
  }
  // A flag without a value, as ever: the scene may follow.
  const Outcome flag = dapple("render --ground climb.glb --width 8 --height 8 --spp 1 -o a.exr");
  EXPECT_EQ(flag.code, 0) << flag.err;
  EXPECT_EQ(noted(flag.err, "ground.* with "), "") << "this is no frame: " << flag.err;
}

TEST_F(FramesAlone, HeightsOfGroundsThatAreNoneAreRefused) {
  const std::string range = " from -1e+12 to 1e+12";
  expect_failure(climb("--frame 0 -o a.exr --ground --ground-height nan"), 2,
                 "--ground-height is nan; it must be" + range);
  expect_failure(climb("--frame 0 -o a.exr --ground --ground-height=-2e12"), 2,
                 "--ground-height is -2e+12; it must be" + range);
  expect_failure(climb("--frame 0 -o a.exr --ground --ground-height low"), 2,
                 "--ground-height low: expected a number" + range);
  expect_failure(climb("--frame 0 -o a.exr --ground-height 1"), 2,
                 "--ground-height needs --ground");
}

}  // namespace
}  // namespace dapple
