// Options of sequences: where a lens focuses without a distance of its own, other noise in each
// frame, the footprint, the sky and the exposure.
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <fstream>

#include "dapple/film.hpp"
#include "support/files/gltf_builder.hpp"
#include "support/files/gltf_data.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class FramesOptions : public ProgramRun {
 protected:
  /// Writes rise.glb: the triangle rises towards a camera that looks down on it.
  void write_rise() const {
    test::GltfBuilder b = test::one_triangle();
    b.add_movement(0, {0, 1}, {0, 0, 0, 0, 1, 0});
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    b.add("nodes", {{"translation", {0.3, 4, 0}},
                    {"rotation", {-0.70710678, 0, 0, 0.70710678}},
                    {"camera", 0}});
    write("rise.glb", b.glb());
  }
  /// Writes dive.glb: grass whose camera is high above it until 1 s, and then on the ground.
  void write_dive() const {
    ASSERT_EQ(dapple("scene 'grass?leaves=4000&length=5' -o grass.glb").code, 0);
    const std::string bytes = bytes_of(path("grass.glb"));
    test::GltfBuilder b;
    b.doc = test::GltfData(path("grass.glb")).doc;
    const std::size_t size = b.doc["buffers"][0]["byteLength"];
    b.bin.assign(bytes.end() - static_cast<std::ptrdiff_t>(size), bytes.end());
    b.doc.erase("buffers");
    const std::size_t camera = 2;  // the last node
    ASSERT_TRUE(b.doc["nodes"][camera].contains("camera"));
    const int above = b.add("nodes", {{"children", {camera}}});
    b.doc["scenes"][0]["nodes"] = {0, 1, above};
    b.add_movement(above, {0, 1}, {0, 1000, 0, 0, 0, 0})["samplers"][0]["interpolation"] = "STEP";
    write("dive.glb", b.glb());
  }
  /// Writes turn.glb: a sun shines on the back of a triangle until 1 s, and then on its front.
  void write_turn(const char* light = "sun") const {
    test::GltfBuilder b = test::one_triangle();
    b.doc["extensionsUsed"] = {"KHR_lights_punctual"};
    b.doc["extensions"]["KHR_lights_punctual"]["lights"] =
        test::json::array({{{"type", "directional"}, {"name", light}, {"intensity", 10}}});
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.2}, {"znear", 0.1}}}});
    b.add("nodes", {{"translation", {0.3, 0.3, 5}}, {"camera", 0}});
    const int sun = b.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    const int times = b.add_accessor(std::vector<float>{0, 1}, test::kFloat, "SCALAR");
    const int values =
        b.add_accessor(std::vector<float>{0, 1, 0, 0, 0, 0, 0, 1}, test::kFloat, "VEC4");
    b.add("animations",
          {{"samplers", {{{"input", times}, {"output", values}, {"interpolation", "STEP"}}}},
           {"channels", {{{"sampler", 0}, {"target", {{"node", sun}, {"path", "rotation"}}}}}}});
    write("turn.glb", b.glb());
  }
  /// Expects that frame 1 is the same in a sequence from frame 0 as by itself.
  void expect_frame_1_by_itself(const std::string& options) const {
    const std::string render = "render " + options + " --width 24 --height 24 --spp 4 --fps 1 -q ";
    for (const char* frames :
         {"--frames 0-1 -o a.#.exr --png a.#.png", "--frames 1-1 -o b.#.exr --png b.#.png"}) {
      const Outcome run = dapple(render + frames);
      ASSERT_EQ(run.code, 0) << run.err;
    }
    EXPECT_EQ(bytes_of(path("a.1.png")), bytes_of(path("b.1.png")));
    EXPECT_EQ(read_exr(path("a.1.exr")).find("R")->pixels,
              read_exr(path("b.1.exr")).find("R")->pixels);
  }
  [[nodiscard]] float focus_distance(const char* name) const {
    const Imf::InputFile file(path(name).c_str());
    const auto& header = file.header();
    return std::stof(header.typedAttribute<Imf::StringAttribute>("dapple:focus_distance").value());
  }
};

TEST_F(FramesOptions, ASequenceKeepsTheFocusOfItsFirstFrame) {
  write_rise();
  ASSERT_EQ(dapple("render rise.glb --width 8 --height 8 --spp 2 --frames 0-1 --fps 1 --aperture "
                   "0.1 --passes ao -o a.#.exr")
                .code,
            0);
  EXPECT_GT(focus_distance("a.0.exr"), 1);
  EXPECT_EQ(focus_distance("a.0.exr"), focus_distance("a.1.exr"));
}

TEST_F(FramesOptions, AFrameAloneHasTheNotedFocusOfTheSequence) {
  write_rise();
  const std::string lens =
      "render rise.glb --width 8 --height 8 --spp 2 --fps 1 --aperture 0.1 --passes ao ";
  const Outcome whole = dapple(lens + "--frames 0-1 -o a.#.exr");
  ASSERT_EQ(whole.code, 0) << whole.err;
  const std::string begin = "in focus there with ";
  const std::size_t at = whole.err.find(begin);
  ASSERT_NE(at, std::string::npos) << whole.err;
  const std::size_t from = at + begin.size();
  const std::string option = whole.err.substr(from, whole.err.find('\n', from) - from);
  EXPECT_TRUE(option.starts_with("--focus-distance ")) << option;
  for (const std::string frame : {"--frame 1 -o b.exr", "--frame 1 --shutter 0,0.1 -o b.exr"}) {
    const Outcome own = dapple(lens + frame);
    ASSERT_EQ(own.code, 0) << own.err;
    EXPECT_LT(focus_distance("b.exr"), focus_distance("a.1.exr") - 0.5f) << "what it shows rose";
    EXPECT_TRUE(contains(own.err, begin)) << own.err;
    const Outcome alike = dapple(lens + frame + " " + option);
    ASSERT_EQ(alike.code, 0) << alike.err;
    EXPECT_EQ(focus_distance("b.exr"), focus_distance("a.1.exr"));
    EXPECT_FALSE(contains(alike.err, begin)) << alike.err;
  }
}

TEST_F(FramesOptions, AFirstFrameThatShowsNothingLeavesTheFootprintToTheNext) {
  write_dive();
  const Outcome run = dapple(
      "render dive.glb --width 64 --height 64 --spp 16 --passes ao --max-bias 0.0001 --frames 0-2 "
      "--fps 1 -q -o a.#.exr --stats-json a.#.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const auto footprint = [&](const char* frame) {
    return test::json::parse(bytes_of(path(frame))).at("footprint").get<double>();
  };
  EXPECT_EQ(footprint("a.0.json"), 4);
  EXPECT_LT(footprint("a.1.json"), 4);
  EXPECT_EQ(footprint("a.2.json"), footprint("a.1.json"));
}

TEST_F(FramesOptions, AFirstFrameThatIsLitFromBehindLeavesSkyAndExposureToTheNext) {
  for (const char* name : {"sun", "back"}) {
    write_turn(name);
    for (const char* passes : {"ao,light,albedo,back", "ao,light,albedo"})
      expect_frame_1_by_itself(std::string("turn.glb --passes ") + passes);
  }
}

TEST_F(FramesOptions, AFirstFrameThatShowsNothingLeavesTheExposureToTheNext) {
  write_dive();
  expect_frame_1_by_itself("dive.glb --passes ao --max-bias 0 --ambient 50");
}

TEST_F(FramesOptions, ThePrintedExposureMakesTheSamePreview) {
  for (const std::string name : {"", ".#"}) {
    const std::string render =
        "render 'scene:tree?leaves=500' --width 48 --height 48 --spp 4 --report-bias 0 " +
        std::string(name.empty() ? "" : "--frames 3-3 ");
    const auto files = [&](const std::string& file) {
      return "-o " + file + name + ".exr --png " + file + name + ".png ";
    };
    const Outcome chosen = dapple(render + files("a"));
    ASSERT_EQ(chosen.code, 0) << chosen.err;
    const std::size_t at = chosen.out.find("--exposure ");
    ASSERT_NE(at, std::string::npos) << chosen.out;
    const std::string option = chosen.out.substr(at, chosen.out.find('\n', at) - at);
    ASSERT_EQ(dapple(render + files("b") + option).code, 0) << option;
    const std::string number = name.empty() ? "" : ".3";
    EXPECT_TRUE(bytes_of(path("a" + number + ".png")) == bytes_of(path("b" + number + ".png")))
        << option;
  }
}

TEST_F(FramesOptions, FramesHaveTheSameNoiseUnlessTheSeedIsAnimated) {
  const std::string scene =
      "render 'scene:tree?leaves=200' --width 24 --height 24 --spp 2 --passes ao --report-bias 0 "
      "--max-bias 0 -q ";
  ASSERT_EQ(dapple(scene + "--frames 3-4 -o still.#.exr").code, 0);
  ASSERT_EQ(dapple(scene + "--frames 3-4 --animate-seed --seed 5 -o noisy.#.exr").code, 0);
  ASSERT_EQ(dapple(scene + "--frames 4-4 --animate-seed --seed 5 -o alone.#.exr").code, 0);
  ASSERT_EQ(dapple(scene + "--frames 9-9 --seed 0 -o other.#.exr").code, 0);
  const auto ao = [&](const char* name) { return read_exr(path(name)).find("ao.R")->pixels; };
  EXPECT_EQ(ao("still.3.exr"), ao("still.4.exr"));
  EXPECT_NE(ao("noisy.3.exr"), ao("noisy.4.exr"));
  EXPECT_EQ(ao("noisy.4.exr"), ao("alone.4.exr"));
  EXPECT_EQ(ao("other.9.exr"), ao("still.3.exr"));
  const Outcome still = dapple(scene + "--animate-seed -o a.exr");
  EXPECT_EQ(still.code, 2);
  EXPECT_NE(still.err.find("--animate-seed needs --frames"), std::string::npos) << still.err;
}

// Scripts give it to all frames: only shutters and motion vectors depend on it.
TEST_F(FramesOptions, FpsGoWithASingleFrameWhosePictureTheyDoNotChange) {
  const std::string render =
      "render 'scene:tree?leaves=200&wind=1' --width 16 --height 9 --spp 2 -q --frame 0.5 ";
  ASSERT_EQ(dapple(render + "-o without.exr").code, 0);
  const Outcome run = dapple(render + "--fps 30 -o with.exr");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(bytes_of(path("with.exr")) == bytes_of(path("without.exr")));
  expect_failure(dapple(render + "--fps 0 -o no.exr"), 2, "--fps must be a number above 0");
}

}  // namespace
}  // namespace dapple
