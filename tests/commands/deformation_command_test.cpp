// What a glTF file says of surfaces and lenses, from the file to the pixels: skins and morph
// targets in sequences of frames, normals of flat meshes, and the lens in a camera's extras.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/files/gltf_builder.hpp"
#include "support/programs/program_run.hpp"
#include "support/scenes/reed.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class DeformationCommand : public ProgramRun {
 protected:
  void write_glb(const char* name, const test::GltfBuilder& file) const { write(name, file.glb()); }
  void render_to(const std::string& output, const std::string& options) const {
    const Outcome run =
        dapple("render " + options + " --width 48 --height 48 --spp 4 -q -o " + output);
    ASSERT_EQ(run.code, 0) << run.err;
  }
  [[nodiscard]] Film film(const std::string& options) const {
    render_to("a.exr", options);
    return read_exr(path("a.exr"));
  }
};

const std::vector<float>& plane(const Film& film, const char* name) {
  return film.find(name)->pixels;
}

double mean(const Film& film, const char* name) {
  double sum = 0;
  for (const float value : plane(film, name)) sum += value;
  return sum / static_cast<double>(plane(film, name).size());
}

void expect_same_bits(const Film& a, const Film& b, const std::vector<const char*>& names) {
  for (const char* name : names) {
    const std::vector<float>&x = plane(a, name), &y = plane(b, name);
    ASSERT_EQ(x.size(), y.size());
    EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(float)), 0) << name;
  }
}

// A sequence refits what the first frame built; a frame alone builds it.
TEST_F(DeformationCommand, ASkinnedTubeInASequenceIsThatOfEachFrameAlone) {
  write_glb("reed.glb", test::Reed().file);
  const std::string options =
      "reed.glb --passes ao,albedo --estimator exact --look-from 1.5,1.5,8 --look-at 1.5,1.5,0 ";
  render_to("all.#.exr", options + "--frames 0-6:3 --fps 4");
  std::vector<Film> films;
  for (const int frame : {0, 3, 6}) {
    SCOPED_TRACE(frame);
    const Film alone = film(options + fmt::format("--frame {}", frame / 4.0));
    films.push_back(read_exr(path(fmt::format("all.{}.exr", frame))));
    const Film& in_sequence = films.back();
    expect_same_bits(alone, in_sequence, {"A"});
    ASSERT_GT(mean(alone, "A"), 0.02);
    for (const char* name : {"P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "albedo.R"})
      for (std::size_t p = 0; p < plane(alone, name).size(); ++p)
        ASSERT_NEAR(plane(in_sequence, name)[p], plane(alone, name)[p], 1e-5) << name << ' ' << p;
    EXPECT_NEAR(mean(in_sequence, "ao.R"), mean(alone, "ao.R"), 1e-5);
  }
  EXPECT_NE(plane(films[0], "A"), plane(films[1], "A")) << "it moves";
  EXPECT_NE(plane(films[1], "A"), plane(films[2], "A"));
}

// A square in front of the camera grows to the right: from one to two metres in a second.
TEST_F(DeformationCommand, AMorphedSquareIsAsWideAsItsWeightSays) {
  test::GltfBuilder b;
  const int square = b.add_mesh(
      {{"attributes",
        {{"POSITION", b.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0})}}},
       {"targets",
        {{{"POSITION",
           b.add_positions({0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0})}}}}});
  b.add("cameras",
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 1.5}, {"ymag", 1.5}, {"znear", 0.1}, {"zfar", 10}}}});
  b.add("nodes", {{"translation", {1, 0.5, 3}}, {"camera", 0}});
  const int times = b.add_accessor(std::vector<float>{0, 1}, test::kFloat, "SCALAR");
  const int weights = b.add_accessor(std::vector<float>{0, 1}, test::kFloat, "SCALAR");
  b.add("animations",
        {{"samplers", {{{"input", times}, {"output", weights}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", square}, {"path", "weights"}}}}}}});
  write_glb("square.glb", b);
  render_to("m.#.exr", "square.glb --passes ao --frames 0-4:2 --fps 4");
  for (const auto& [frame, width] : {std::pair(0, 1.0), {2, 1.5}, {4, 2.0}})
    EXPECT_NEAR(mean(read_exr(path(fmt::format("m.{}.exr", frame))), "A"), width / 9, 0.01);
}

TEST_F(DeformationCommand, TheNormalsOfFlatMeshesChangeNoBit) {
  for (const char* scene : {"'scene:cube?divisions=2'", "'scene:cloud?leaves=500'"}) {
    SCOPED_TRACE(scene);
    const std::string options = std::string(scene) + " --ground --passes ao,light --normals ";
    const Film smooth = film(options + "shading"), faceted = film(options + "geometric");
    EXPECT_GT(mean(smooth, "ao.R"), 0.1);
    expect_same_bits(smooth, faceted, {"A", "ao.R", "light.sun.R", "N.X", "N.Y", "N.Z", "P.X"});
  }
}

TEST_F(DeformationCommand, AViewFromAboveHasNorthAboveUnlessItIsToldAnother) {
  test::GltfBuilder b = test::one_triangle();
  const auto half = static_cast<float>(std::sqrt(0.5));
  b.doc["nodes"][0]["rotation"] = {-half, 0, 0, half};  // Y to -Z
  write_glb("flat.glb", b);
  const std::string above = "flat.glb --look-from 0.5,3,-0.5 --look-at 0.5,0,-0.5 --passes ao ";
  const Film north = film(above);
  expect_same_bits(north, film(above + "--up 0,0,-1"), {"A", "P.X", "P.Z"});
  EXPECT_GT(mean(north, "A"), 0.01);
  EXPECT_NE(plane(north, "A"), plane(film(above + "--up 1,0,0"), "A"));
  expect_same_bits(north, film(above + "--half ' N , ao '"), {"A"});
}

TEST_F(DeformationCommand, TheLensInACamerasExtrasIsThatOfTheOptions) {
  test::GltfBuilder b = test::one_triangle();
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"znear", 0.1}}}});
  b.add("nodes", {{"translation", {0.3, 0.3, 3}}, {"camera", 0}});
  write_glb("pinhole.glb", b);
  b.doc["cameras"][0]["extras"] = {{"dapple_aperture", 0.2}, {"dapple_focus_distance", 2.0}};
  write_glb("lens.glb", b);
  const Film sharp = film("pinhole.glb --passes ao"), blurred = film("lens.glb --passes ao");
  const Film chosen = film("pinhole.glb --passes ao --aperture 0.2 --focus-distance 2");
  expect_same_bits(blurred, chosen, {"A", "ao.R", "P.X"});
  const auto partly = [](const Film& film) {
    return std::count_if(plane(film, "A").begin(), plane(film, "A").end(),
                         [](float alpha) { return alpha > 0 && alpha < 1; });
  };
  EXPECT_GT(partly(blurred), 3 * partly(sharp));
}

}  // namespace
}  // namespace dapple
