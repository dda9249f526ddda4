// The options --frame and --frames of dapple render: one file for each frame, named by its number;
// what stays the same in all frames; what is said of scenes that do not move; and arguments that
// are refused before anything is rendered.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <thread>

#include "support/files/gltf_builder.hpp"
#include "support/files/hair_builder.hpp"
#include "support/programs/program_run.hpp"
#include "support/programs/running_program.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class FramesCommand : public ProgramRun {
 protected:
  /// Writes climb.glb, a triangle that moves up at 1 m/s from 0 s to 1 s.
  void write_climb() const {
    test::GltfBuilder b = test::one_triangle();
    b.add_movement(0, {0, 1}, {0, 0, 0, 0, 1, 0})["name"] = "climb";
    write("climb.glb", b.glb());
  }
  /// Writes blink.glb, a triangle with a lamp and a camera that are scaled to nothing at 0 s and at
  /// 2 s. `steady`: another camera is not.
  void write_blink(bool steady = false) const {
    test::GltfBuilder b = test::one_triangle();
    b.doc["extensions"]["KHR_lights_punctual"]["lights"] =
        test::json::array({{{"type", "point"}, {"name", "lamp"}, {"intensity", 100}}});
    b.doc["extensionsUsed"] = {"KHR_lights_punctual"};
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    const auto lamp = b.doc["nodes"].size();
    b.add("nodes",
          {{"translation", {0, 0, 5}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    b.add("nodes", {{"translation", {0, 0, 3}}, {"camera", 0}});
    if (steady) b.add("nodes", {{"translation", {0, 0, 4}}, {"camera", 0}, {"name", "steady"}});
    const int times = b.add_accessor(std::vector<float>{0, 1, 2}, test::kFloat, "SCALAR");
    const int values = b.add_positions({0, 0, 0, 1, 1, 1, 0, 0, 0});
    test::json channels = test::json::array();
    for (const auto node : {lamp, lamp + 1})
      channels.push_back({{"sampler", 0}, {"target", {{"node", node}, {"path", "scale"}}}});
    b.add("animations",
          {{"samplers", {{{"input", times}, {"output", values}}}}, {"channels", channels}});
    write("blink.glb", b.glb());
  }
  static int count(const std::string& text, const std::string& part) {
    int found = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++found;
    return found;
  }
  [[nodiscard]] Outcome small_render(const std::string& scene, const std::string& options) const {
    return dapple("render " + scene + " --width 8 --height 8 --spp 2 " + options);
  }
  [[nodiscard]] bool is_there(const char* name) const {
    return std::filesystem::exists(path(name));
  }
  [[nodiscard]] Outcome climb(const std::string& arguments) const {
    return dapple("render climb.glb --width 16 --height 16 --spp 1 --seed 3 " + arguments);
  }
  [[nodiscard]] std::vector<float> ao(const char* name) const {
    return read_exr(path(name)).find("ao.R")->pixels;
  }
  /// Mean height of the points that camera rays hit, in metres.
  [[nodiscard]] double height(const char* name) const {
    const Film film = read_exr(path(name));
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < film.find("A")->pixels.size(); ++i) {
      sum += film.find("A")->pixels[i] * film.find("P.Y")->pixels[i];
      weight += film.find("A")->pixels[i];
    }
    return sum / weight;
  }
};

TEST_F(FramesCommand, AFrameShowsTheSceneAtItsTime) {
  write_climb();
  const std::string camera = " --look-from 0.3,0.8,4 --look-at 0.3,0.8,0 --passes ao -q";
  ASSERT_EQ(climb("-o rest.exr" + camera).code, 0);
  ASSERT_EQ(climb("-o half.exr --frame 0.5" + camera).code, 0);
  ASSERT_EQ(climb("-o late.exr --frame 9 --animation climb" + camera).code, 0);
  EXPECT_NEAR(height("half.exr") - height("rest.exr"), 0.5, 0.1);
  EXPECT_NEAR(height("late.exr") - height("rest.exr"), 1.0, 0.1);
}

TEST_F(FramesCommand, ASequenceWritesAFileOfEveryKindForEachFrame) {
  write_climb();
  const Outcome run = climb(
      "--frames 8-12:2 --fps 10 -o a.####.exr --png a_##.png --stats-json a#.json "
      "--passes ao,visits");
  ASSERT_EQ(run.code, 0) << run.err;
  for (const char* name : {"a.0008.exr", "a.0010.exr", "a.0012.exr", "a_08.png", "a_12.png",
                           "a_08_visits.png", "a8.json", "a10.json", "a12.json"})
    EXPECT_TRUE(is_there(name)) << name;
  EXPECT_EQ(files_in_folder(), 3u * 4 + 1);
  EXPECT_TRUE(contains(run.out, "frame 8 (1 of 3), at 0.800 s")) << run.out;
  EXPECT_TRUE(contains(run.out, "frame 12 (3 of 3), at 1.200 s")) << run.out;
  EXPECT_TRUE(contains(run.out, "wrote a.0012.exr, a_12.png and a_12_visits.png")) << run.out;
  EXPECT_NEAR(height("a.0010.exr") - height("a.0008.exr"), 0.2, 0.1);
  EXPECT_NEAR(height("a.0012.exr"), height("a.0010.exr"), 1e-5) << "the animation ends at 1 s";
}

TEST_F(FramesCommand, AFrameOfASequenceShowsWhatThatFrameAloneShows) {
  write_climb();
  const std::string options = " --look-from 1,1,4 --look-at 0,1,0 -q --passes ao -o ";
  ASSERT_EQ(climb("--frames 0-3 --fps 4" + options + "all.#.exr").code, 0);
  ASSERT_EQ(climb("--frames 3-3 --fps 4" + options + "one.#.exr").code, 0);
  ASSERT_EQ(climb("--frame 0.75" + options + "still.exr").code, 0);
  EXPECT_NEAR(height("all.3.exr"), height("one.3.exr"), 1e-5);
  EXPECT_NEAR(height("all.3.exr"), height("still.exr"), 1e-5);
}

TEST_F(FramesCommand, CameraLightAndGroundOfASequenceStandStill) {
  write_climb();
  const Outcome run = climb("--frames 0-1 --fps 1 -o a.#.exr --ground");
  ASSERT_EQ(run.code, 0) << run.err;
  const Film first = read_exr(path("a.0.exr")), last = read_exr(path("a.1.exr"));
  EXPECT_EQ(first.metadata.world_to_camera, last.metadata.world_to_camera);
  // The lowest row of both pictures shows the ground, at the same height.
  const std::size_t below = first.find("P.Y")->pixels.size() - 1;
  EXPECT_NEAR(first.find("P.Y")->pixels[below], last.find("P.Y")->pixels[below], 0.01)
      << "the triangle is 1 m higher";
  EXPECT_NE(last.find("light.sun.R"), nullptr);
  EXPECT_NE(last.find("light.sky.R"), nullptr);
  EXPECT_EQ(count(run.err, "no lights in the scene"), 1) << run.err;
}

TEST_F(FramesCommand, WhatIsScaledToNothingAtFirstChangesNeitherLightsNorCameraLater) {
  write_blink();
  const std::string render = "render blink.glb --width 16 --height 16 --spp 4 ";
  const Outcome run = dapple(render + "--frames 0-2 --fps 1 -o a.#.exr");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err, "(\"lamp\") is dark: its node is scaled to nothing")) << run.err;
  Film films[3];
  for (int i = 0; i < 3; ++i) {
    films[i] = read_exr(path(fmt::format("a.{}.exr", i).c_str()));
    EXPECT_NE(films[i].find("light.lamp.R"), nullptr) << i;
    EXPECT_EQ(films[i].find("light.sun.R"), nullptr) << "the file has a light";
    EXPECT_EQ(films[i].metadata.world_to_camera, films[0].metadata.world_to_camera) << i;
  }
  const auto brightest = [&](int i) {
    const auto& values = films[i].find("R")->pixels;
    return *std::max_element(values.begin(), values.end());
  };
  EXPECT_LT(brightest(2), 0.5f * brightest(1)) << "the sky is that of the first frame that is lit";
  const Outcome shutter = dapple(render + "--frame 1 --fps 1 --shutter=-1,1 -o b.exr");
  EXPECT_EQ(shutter.code, 0) << shutter.err;
  const Outcome lost = dapple(render + "--frames 1-2 --fps 1 -o c.#.exr");
  EXPECT_EQ(lost.code, 3);
  EXPECT_TRUE(contains(lost.err, "camera_0 is scaled to nothing at some moments; --look-from"))
      << lost.err;
}

TEST_F(FramesCommand, ASequenceKeepsTheCameraOfItsFirstFrame) {
  write_blink(true);
  const Outcome run =
      dapple("render blink.glb --width 16 --height 16 --spp 1 --frames 0-2 --fps 1 -o a.#.exr");
  ASSERT_EQ(run.code, 0) << run.err;
  const Film first = read_exr(path("a.0.exr")), second = read_exr(path("a.1.exr"));
  EXPECT_EQ(first.metadata.world_to_camera, second.metadata.world_to_camera);
  const Outcome lost =
      dapple("render blink.glb --width 16 --height 16 --spp 1 --frames 1-2 --fps 1 -o b.#.exr");
  EXPECT_EQ(lost.code, 3) << "the first camera, which the first frame shows, is gone";
}

TEST_F(FramesCommand, InfoListsAnimationsWithTheirLengths) {
  write_climb();
  const Outcome run = dapple("info climb.glb");
  EXPECT_TRUE(contains(run.out, "animations  climb (1.00 s)")) << run.out << run.err;
}

TEST_F(FramesCommand, AWindyTreeMovesFromFrameToFrame) {
  const Outcome run = dapple(
      "render 'scene:tree?leaves=300&wind=1' --frames 0-1 --fps 2 -o a.#.exr --width 16 --height "
      "16 "
      "--spp 1 -q");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(ao("a.0.exr"), ao("a.1.exr"));
}

// As in tests/render/bias/footprint_pilot_test.cpp: just enough samples that a footprint is chosen,
// and a few pixels of the picture.
TEST_F(FramesCommand, AFrameByItselfKeepsTheFootprintAndSoDoesOneThatIsGiven) {
  const auto footprint = [&](const std::string& options) {
    const Outcome run = dapple(
        "render 'scene:grass?leaves=60000&length=30' --width 256 --height 256 --spp 16 --passes ao "
        "--crop 96,200,159,215 -q -o a.exr --stats-json a.json " +
        options);
    EXPECT_EQ(run.code, 0) << run.err;
    return test::json::parse(bytes_of(path("a.json"))).at("footprint").get<double>();
  };
  EXPECT_LT(footprint(""), 4);
  EXPECT_EQ(footprint("--frame 0"), 4) << "frames that are rendered one by one must be alike";
  EXPECT_EQ(footprint("--footprint 4"), 4);
}

TEST_F(FramesCommand, ASequenceKeepsTheFootprintThatItsFirstFrameChose) {
  const Outcome run = dapple(
      "render 'scene:grass?leaves=60000&length=30' --width 256 --height 256 --spp 16 --passes ao "
      "--crop 96,200,159,215 --frames 0-1 -q -o a.#.exr --stats-json a.#.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const auto first = test::json::parse(bytes_of(path("a.0.json"))),
             second = test::json::parse(bytes_of(path("a.1.json")));
  EXPECT_LT(first.at("footprint"), 4);
  EXPECT_EQ(second.at("footprint"), first.at("footprint"));
  const auto chooses = [](const test::json& statistics) {
    return statistics.dump().find("bias pilot") != std::string::npos;
  };
  EXPECT_TRUE(chooses(first));
  EXPECT_FALSE(chooses(second));
}

TEST_F(FramesCommand, InvalidArgumentsAreRefusedBeforeAnythingIsRendered) {
  const auto refuses = [&](const std::string& arguments, const std::string& part) {
    SCOPED_TRACE(arguments);
    expect_failure(dapple("render scene:cube " + arguments), 2, part);
  };
  refuses("--frames 1-2 -o out.exr", "--output out.exr: with --frames its name needs a place");
  refuses("--frames 1-2 -o 'dir#/out.exr'", "needs a place for the frame's number");
  refuses("--frames 1-2 -o o.#.exr --png p.png", "--png p.png: with --frames");
  refuses("--frames 1-2 -o o.#.exr --stats-json s.json", "--stats-json s.json: with --frames");
  refuses("--frames 0-10 -o o.#.exr --deep o.1#.exr",
          "--output o.10.exr: is the --deep of another frame");
  refuses("--frames 1-2 -o o.#.exr --checkpoint c", "--checkpoint is for one image");
  refuses("--frames 1-2 -o o.#.exr --resume c", "--resume is for one image");
  refuses("--frames 1-2 --frame 1 -o o.#.exr", "--frame");
  refuses("--frames 1-2 --crop 0,0,3,3 -o o.#.dapple", "--crop with --frames needs --ambient");
  refuses("--fps 24 -o o.exr", "--fps needs --frame, --frames, --shutter or --passes motion");
  refuses("--passes motion -o o.exr", "--passes motion needs --frame or --frames");
  refuses("--shutter 0,1 -o o.exr", "--shutter needs --frame or --frames");
  refuses("--frame 1 --shutter 1,0 -o o.exr", "--shutter 1,0: it must close after it opens");
  refuses("--frame 1 --shutter 1 -o o.exr", "--shutter 1: expected OPEN,CLOSE");
  refuses("--frame 1 --shutter 0,nan -o o.exr", "--shutter: 'nan' is not a number");
  refuses("--frame 1 --motion-samples 2 -o o.exr", "--shutter");
  refuses("--frame 1 --shutter 0,1 --motion-samples -1 -o o.exr", "--motion-samples is -1");
  refuses("--frame 1 --shutter 0,1 --motion-samples 17 -o o.exr", "from 1 to --spp (16)");
  refuses("--frame 1 --shutter 0,1 --target-rmse 0.1 -o o.exr", "do not go with --shutter");
  refuses("--frame 1 --shutter 0,1 --checkpoint c -o o.exr", "do not go with --shutter");
  refuses("--aperture nan -o o.exr", "--aperture is nan; it must be from 0 to 1000000");
  refuses("--aperture -1 -o o.exr", "--aperture is -1; it must be from 0 to 1000000");
  refuses("--aperture x -o o.exr", "--aperture");
  refuses("--focus-distance 0 --aperture 1 -o o.exr", "--focus-distance is 0; it must be from");
  refuses("--focus-distance 3 -o o.exr", "--focus-distance needs --aperture");
  refuses("--frames 2-1 -o o.#.exr", "--frames 2-1: expected the first frame before the last");
  refuses("--frames 1-2:0 -o o.#.exr", "--frames 1-2:0: expected numbers");
  refuses("--frames 1-9999999 -o o.#.exr", "at most 100000 frames");
  refuses("--frames 1-2-3 -o o.#.exr", "--frames 1-2-3: expected A-B");
  refuses("--frames a -o o.#.exr", "'a' is not a whole number");
  refuses("--frames -1-2 -o o.#.exr", "--frames");
  refuses("--frames 1-2 --fps 0 -o o.#.exr", "--fps must be a number above 0");
  refuses("--frame nan -o o.exr", "--frame");
  refuses("--frame inf -o o.exr", "--frame must be a finite number");
  for (const char* more : {"--passes motion", "--shutter 0,1 --spp 8"}) {
    refuses(std::string(more) + " --frame nan -o o.exr", "--frame must be a finite number");
    refuses(std::string(more) + " --frame inf -o o.exr", "--frame must be a finite number");
  }
  refuses("--frames 5-6 --fps 1e-308 -o o.#.exr", "--frame must be a finite number");
  refuses("--animation walk -o o.exr", "--animation needs --frame or --frames");
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(FramesCommand, OfWhatDoesNotMoveStayAtRestAndSaySoOnce) {
  write("still.glb", test::one_triangle().glb());
  write("a.hair", test::two_strands().bytes());
  const std::string rest = ": has no animations, and stays in its rest pose";
  const std::pair<const char*, std::string> cases[] = {
      {"still.glb", "still.glb" + rest},
      {"'scene:forest?trees=2&leaves=10'", "scene:forest?trees=2&leaves=10" + rest},
      {"'scene:tree?leaves=10'", "scene:tree?leaves=10" + rest + "; with wind=1 it moves"},
      {"a.hair", "a.hair: hair has no animations, and stays"},
  };
  for (const auto& [scene, note] : cases) {
    for (const char* time : {"--frame 2 -o a.exr", "--frames 1-2 --animation '*' -o a.#.exr"}) {
      SCOPED_TRACE(std::string(scene) + " " + time);
      const Outcome run = small_render(scene, time);
      EXPECT_EQ(run.code, 0) << run.err;
      EXPECT_EQ(count(run.err, "note: " + note + "\n"), 1) << run.err;
    }
    EXPECT_FALSE(contains(small_render(scene, "-o a.exr").err, "has no animations")) << scene;
  }
  const Outcome windy = small_render("'scene:tree?leaves=10&wind=1'", "--frame 2 -o a.exr");
  EXPECT_FALSE(contains(windy.err, "has no animations")) << windy.err;
}

TEST_F(FramesCommand, AnAnimationThatASceneOfAnyKindDoesNotHaveIsRefused) {
  write("still.glb", test::one_triangle().glb());
  write("a.hair", test::two_strands().bytes());
  for (const char* scene : {"still.glb", "a.hair", "scene:tree?wind=1", "scene:cube"}) {
    SCOPED_TRACE(scene);
    const std::string what = "--animation walk: " + std::string(scene) + " has no animations";
    const std::string quoted = "'" + std::string(scene) + "'";
    expect_failure(small_render(quoted, "--animation walk --frame 1 -o a.exr"), 2, what);
    expect_failure(small_render(quoted, "--animation walk --frames 1-2 -o a.#.exr"), 2, what);
    expect_failure(dapple("info " + quoted + " --animation walk --frame 1"), 2, what);
    expect_failure(dapple("info " + quoted + " --animation walk"), 2, "--animation needs --frame");
  }
}

TEST_F(FramesCommand, ALineRadiusWithoutLinesIsNoted) {
  write("still.glb", test::one_triangle().glb());
  write("a.hair", test::two_strands().bytes());
  for (const std::string scene : {"still.glb", "a.hair", "scene:cube"}) {
    const std::string note =
        "note: " + scene + ": has no glTF lines, and --line-radius changes nothing\n";
    for (const char* time : {"-o a.exr", "--frames 1-2 -o a.#.exr"}) {
      SCOPED_TRACE(scene + " " + time);
      const std::string options = std::string("--line-radius 0.01 ") + time;
      EXPECT_EQ(count(small_render(scene, options).err, note), 1);
      EXPECT_EQ(count(small_render(scene, time).err, "--line-radius"), 0);
    }
  }
}

/// Ways to render a scene at rest: each adds opacities and ground at another place.
constexpr const char* kKinds[] = {"-o a.exr", "--frame 0 -o a.exr", "--frames 0-0 -o a.exr#",
                                  "--frame 0 --shutter 0,1 --motion-samples 2 -o a.exr",
                                  "--frame 0 --passes ao,motion -o a.exr"};

TEST_F(FramesCommand, TheAddedGroundIsNoMaterialThatAnOpacityCanBeFor) {
  write_climb();
  for (const char* kind : kKinds) {
    SCOPED_TRACE(kind);
    expect_failure(small_render("climb.glb", std::string("--ground --opacity ground=0.5 ") + kind),
                   2, "climb.glb: there is no material \"ground\"; there are: \"default\"");
  }
  EXPECT_EQ(files_in_folder(), 1u);
}

// The disk's own ground disappears; the camera looks down on the added one, which is as high.
TEST_F(FramesCommand, AnOpacityOfTheScenesOwnGroundLeavesTheAddedGroundOpaque) {
  for (const char* kind : kKinds) {
    SCOPED_TRACE(kind);
    const auto alpha_below = [&](const std::string& options) {
      const Outcome run = small_render("scene:disk", options + kind);
      EXPECT_EQ(run.code, 0) << run.err;
      const std::string file = std::string(kind).ends_with('#') ? "a.exr0" : "a.exr";
      const Film film = read_exr(path(file));
      const auto is_named = [](const auto& setting) {
        return setting == std::pair<std::string, std::string>("opacity_ground", "0");
      };
      const auto& settings = film.metadata.settings;
      EXPECT_EQ(std::count_if(settings.begin(), settings.end(), is_named), 1);
      return film.find("A")->pixels.back();
    };
    EXPECT_EQ(alpha_below("--opacity ground=0 "), 0);
    EXPECT_EQ(alpha_below("--opacity ground=0 --ground "), 1);
  }
}

TEST_F(FramesCommand, AnOutputOfAFrameThatIsTheInputIsRefused) {
  write_climb();
  std::filesystem::copy(path("climb.glb"), path("climb.2.glb"));
  const Outcome run =
      dapple("render climb.2.glb --frames 1-3 -o 'climb.#.glb' --width 8 --height 8");
  expect_failure(run, 2, "--output climb.2.glb: would overwrite climb.2.glb, which is read");
  EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(FramesCommand, AnInterruptionEndsTheSequenceAfterTheCurrentFrame) {
  const std::string log = folder_.string() + ".log";
  for (int delay = 300; !is_there("a.0.exr") && delay < 60'000; delay *= 2) {
    RunningProgram program({"render", "scene:tree?leaves=2000&wind=1", "--frames", "0-9", "-o",
                            path("a.#.exr"), "--width", "64", "--height", "64", "--spp", "1048576"},
                           log);
    std::this_thread::sleep_for(Milliseconds(delay));
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 143);
  }
  EXPECT_TRUE(is_there("a.0.exr"));
  EXPECT_FALSE(is_there("a.1.exr"));
  std::filesystem::remove(log);
}

}  // namespace
}  // namespace dapple
