// dapple points as a command: the report of the bias and its limit, columns of bent normals, suns
// and the sky, and skies that turn.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>

#include "dapple/film.hpp"
#include "support/files/gltf_builder.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using film_test::bytes_of;
using film_test::contains;

class PointsCommand : public program_test::ProgramRun {
 protected:
  /// Of a grid under a tree; fails unless it succeeds.
  program_test::Outcome measured(const std::string& arguments) {
    const program_test::Outcome run =
        dapple("points 'scene:tree?leaves=3000' --grid=-2,-2,2,2,0.4 --rays 64 " + arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return run;
  }

  /// In the first row of a CSV file.
  double value_of(const std::string& name, const std::string& column) {
    std::ifstream in(path(name));
    std::string names, values;
    std::getline(in, names);
    std::getline(in, values);
    std::istringstream of_names(names), of_values(values);
    for (std::string one, value; std::getline(of_names, one, ',');) {
      std::getline(of_values, value, ',');
      if (one == column) return std::stod(value);
    }
    ADD_FAILURE() << "no column " << column;
    return 0;
  }

  std::string first_line(const std::string& name) {
    std::ifstream in(path(name));
    std::string line;
    std::getline(in, line);
    return line;
  }
};

TEST_F(PointsCommand, ReportsTheBiasUnlessToldNotTo) {
  EXPECT_TRUE(contains(measured("-o a.csv").out, "bias of ao"));
  EXPECT_FALSE(contains(measured("-o b.csv --report-bias 0").out, "bias of ao"));
  EXPECT_EQ(bytes_of(path("a.csv")), bytes_of(path("b.csv")));
}

TEST_F(PointsCommand, KeepsALimitOfTheBiasAndSaysWithWhichFootprint) {
  const program_test::Outcome run = measured("-o a.csv --max-bias 1e-7");
  EXPECT_TRUE(contains(run.err, "exact rays (footprint 0)")) << run.err;
  measured("-o b.csv --footprint 0");
  EXPECT_EQ(bytes_of(path("a.csv")), bytes_of(path("b.csv")));
}

TEST_F(PointsCommand, SaysThatALimitOfTheBiasHasNoEffectOnExactRays) {
  const program_test::Outcome run = measured("-o a.csv --max-bias 0.01 --footprint 0");
  EXPECT_TRUE(contains(run.err, "--max-bias has no effect")) << run.err;
}

// All values are 0 or 1: nothing is corrected, and the bias is 0 within what so many rays tell.
TEST_F(PointsCommand, ReportsABiasWhereNothingIsCorrected) {
  std::ofstream(path("above.csv")) << "x,y,z,nx,ny,nz\n0,90,0,0,1,0\n1,90,0,0,1,0\n";
  const program_test::Outcome run =
      dapple("points 'scene:tree?leaves=10' --at above.csv --rays 64 -o a.csv --stats-json a.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const auto json = nlohmann::json::parse(bytes_of(path("a.json")));
  const auto& ao = json.at("bias").at("ao");
  EXPECT_EQ(ao.at("mean"), 0);
  EXPECT_GT(ao.at("error").get<double>(), 0);
  double sum = 0;
  for (const char* key : {"load", "prepare", "build", "trace", "write"}) {
    EXPECT_GE(json.at("seconds").at(key).get<double>(), 0) << key;
    sum += json["seconds"][key].get<double>();
  }
  const double total = json["seconds"]["total"].get<double>();
  EXPECT_NEAR(sum, total, 0.01 + 0.05 * total);
}

TEST_F(PointsCommand, TurnsAnImageOfTheSkyAndDoesNotOverwriteIt) {
  Film sky;
  sky.width = 8;
  sky.height = 4;
  sky.data_window = {0, 0, 7, 3};
  std::vector<float> pixels(32, 0.01f);
  pixels[11] = pixels[12] = pixels[19] = pixels[20] = 10;  // towards +Z
  for (const char* channel : {"R", "G", "B"}) sky.planes.push_back({channel, pixels});
  write_exr(sky, path("sky.exr"));
  std::ofstream(path("at.csv")) << "x,y,z,nx,ny,nz\n0,50,0,0,0,1\n";
  std::ofstream(path("to_x.csv")) << "x,y,z,nx,ny,nz\n0,50,0,1,0,0\n";
  const std::string lit = "points 'scene:tree?leaves=10' --sky sky.exr --at at.csv -o ";
  const auto red = [&](const std::string& options, const std::string& at = "at.csv") {
    const program_test::Outcome run =
        dapple("points 'scene:tree?leaves=10' --sky sky.exr --at " + at + " -o out.csv " + options);
    EXPECT_EQ(run.code, 0) << run.err;
    return value_of("out.csv", "sky_r");
  };
  EXPECT_GT(red(""), 5.0);
  EXPECT_LT(red("--sky-rotation 180"), 0.5);
  EXPECT_GT(red("--sky-rotation=90", "to_x.csv"), 5.0);
  EXPECT_LT(red("--sky-rotation=-90", "to_x.csv"), 0.5);
  EXPECT_EQ(dapple(lit + "no.csv --sky-rotation nan").code, 2);
  const program_test::Outcome needs =
      dapple("points scene:tree --at at.csv --sky uniform --sky-rotation 3 -o no.csv");
  EXPECT_TRUE(contains(needs.err, "--sky-rotation needs --sky with an image")) << needs.err;
  const std::string before = bytes_of(path("sky.exr"));
  EXPECT_EQ(dapple(lit + "out.csv --stats-json sky.exr").code, 2);
  EXPECT_EQ(bytes_of(path("sky.exr")), before);
}

TEST_F(PointsCommand, TheSceneMayComeAfterListsOfNumbers) {
  const program_test::Outcome run = dapple(
      "points --grid=-1,-1,1,1,1 --periodic 4,4 --opacity leaf=0.5 'scene:tree?leaves=100' "
      "-o a.csv --rays 8");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(dapple("points --grid 0,0,1,1,1 'scene:tree?leaves=100' -o a.csv --rays 8").code, 0);
  const program_test::Outcome suns =
      dapple("points 'scene:tree?leaves=100' --grid 0,0,1,1,1 -o b.csv --per-sun");
  EXPECT_TRUE(contains(suns.err, "--per-sun needs --suns")) << suns.err;
}

// As in a render: the plane that --ground adds is no material of the file.
TEST_F(PointsCommand, RefusesAnOpacityForTheAddedGround) {
  const program_test::Outcome run =
      dapple("points 'scene:tree?leaves=30' --per-triangle --ground --opacity ground=0 -o a.csv");
  EXPECT_EQ(run.code, 2);
  EXPECT_TRUE(contains(run.err, "there is no material \"ground\"")) << run.err;
}

TEST_F(PointsCommand, RefusesAHeightWithoutAGrid) {
  const program_test::Outcome run =
      dapple("points 'scene:tree?leaves=3000' --per-triangle --height 1 -o a.csv");
  EXPECT_EQ(run.code, 2);
  EXPECT_TRUE(contains(run.err, "--height needs --grid")) << run.err;
}

TEST_F(PointsCommand, SumsSunsWithAStandardErrorOrWritesEach) {
  std::ofstream suns(path("suns.csv"));
  suns << "azimuth,elevation,irradiance\n";
  for (int i = 0; i < 90; ++i) suns << 2 * i << "," << 10 + i % 60 << ",800\n";
  suns.close();
  const program_test::Outcome run = measured("-o sum.csv --suns suns.csv");
  EXPECT_TRUE(contains(run.out, "bias of sun")) << run.out;
  EXPECT_TRUE(contains(first_line("sum.csv"), ",sun,sun_error")) << first_line("sum.csv");
  measured("-o each.csv --suns suns.csv --per-sun");
  EXPECT_TRUE(contains(first_line("each.csv"), ",sun_0,sun_1")) << first_line("each.csv");
  EXPECT_FALSE(contains(first_line("each.csv"), "sun_90"));
}

TEST_F(PointsCommand, NotesOptionsThatMayNotDoWhatWasMeant) {
  const std::string cube = "points 'scene:cube?divisions=1' --grid=-4,-4,4,4,4 -o a.CSV --rays ";
  const std::string odd = dapple(cube + "20 --ground --height=-1 --periodic 0.5,100").err;
  EXPECT_TRUE(contains(odd, "--rays is 20; 16 are traced, a multiple of 8")) << odd;
  EXPECT_TRUE(contains(odd, "9 of 9 points lie below the ground, which is at y = ")) << odd;
  EXPECT_TRUE(contains(odd, " m wide along X, and its period 0.5 m: copies overlap")) << odd;
  EXPECT_FALSE(contains(odd, "along Z")) << odd;
  const program_test::Outcome even = dapple(cube + "16 --ground --height 2 --periodic 0.9,100");
  EXPECT_EQ(even.code, 0) << even.err;
  for (const char* note : {"--rays", "below the ground", "overlap"})
    EXPECT_FALSE(contains(even.err, note)) << even.err;
}

TEST_F(PointsCommand, NamesTheColumnsThatResultsReplace) {
  const std::string cube = "points 'scene:cube?divisions=1' --rays 8 -o a.csv --at ";
  std::ofstream(path("one.csv")) << "x,y,z,id,ao\n0,9,0,7,0.5\n";
  const program_test::Outcome one = dapple(cube + "one.csv");
  EXPECT_TRUE(contains(one.err, "one.csv: its column ao is replaced by the result of that name"))
      << one.err;
  std::ofstream(path("two.csv")) << "x,y,z,ao,ao_error\n0,9,0,0.5,0\n";
  const program_test::Outcome two = dapple(cube + "two.csv");
  EXPECT_TRUE(contains(two.err, "its columns ao, ao_error are replaced by the results of these"))
      << two.err;
}

TEST_F(PointsCommand, TellsSunsInRadiansAndFilesWithoutPoints) {
  std::ofstream(path("suns.csv")) << "azimuth,elevation,irradiance\n3.1,1.2,800\n";
  std::ofstream(path("at.csv")) << "x,y,z\n";
  const program_test::Outcome run =
      dapple("points 'scene:cube?divisions=1' --rays 8 -o a.csv --at at.csv --suns suns.csv");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err, "suns.csv: angles are taken as degrees; these look")) << run.err;
  EXPECT_TRUE(contains(run.err, "at.csv: no points")) << run.err;
}

TEST_F(PointsCommand, SaysThatScenesOfOtherFormatsMustBecomeGltf) {
  std::ofstream(path("a.OBJ")) << "o cube\nv 0 0 0\n";
  std::ofstream(path("a.stl")) << "solid cube\n";
  for (const std::string command : {"info a.OBJ", "points a.stl --per-triangle -o a.csv"})
    expect_failure(dapple(command), 3, "is not glTF; scenes are glTF (.gltf, .glb) or HAIR files");
  std::ofstream(path("a.glb")) << "solid cube\n";
  expect_failure(dapple("info a.glb"), 3, "is not glTF: parse error");
}

// A wall close to the point hides the sky where x is above 0. What is left of the cosine-weighted
// directions has the mean (-2, pi, 0), but for its length: tests/points/bent_and_suns_test.cpp.
TEST_F(PointsCommand, WritesBentNormalsAndEachSunInColumnsOfTheirOwn) {
  test::GltfBuilder wall;
  wall.add_mesh(
      {{"attributes",
        {{"POSITION", wall.add_positions({0.1f, -1, -300, 0.1f, -1, 300, 0.1f, 300, 0})}}}});
  write("wall.glb", wall.glb());
  std::ofstream(path("at.csv")) << "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n";
  std::ofstream(path("suns.csv")) << "azimuth,elevation,irradiance\n270,30,800\n90,30,700\n";
  const program_test::Outcome run = dapple(
      "points wall.glb --at at.csv -o out.csv --rays 65536 --estimator exact --bent "
      "--suns suns.csv --per-sun");
  ASSERT_EQ(run.code, 0) << run.err;
  const double length = std::hypot(2.0, std::numbers::pi);
  EXPECT_NEAR(value_of("out.csv", "bent_x"), -2 / length, 0.015);
  EXPECT_NEAR(value_of("out.csv", "bent_y"), std::numbers::pi / length, 0.015);
  EXPECT_NEAR(value_of("out.csv", "bent_z"), 0, 0.015);
  EXPECT_NEAR(value_of("out.csv", "sun_0"), 800 * 0.5, 0.01);
  EXPECT_NEAR(value_of("out.csv", "sun_1"), 0, 0.01) << "behind the wall";
}

// Every ray of the point is free. The sky's irradiance is a mean of 9 / 7 * (1 + 2 c) / 3 over rays
// that have the cosine c with the density 2 c: 1, with a standard deviation of 0.2. Of 1,024 rays
// the mean has 0.0063, and the tolerance is five times that. The sun's is a sum of like numbers.
TEST_F(PointsCommand, TheColumnsOfTheSkyAreItsOwnWhereASunHasItsName) {
  std::ofstream(path("suns.json")) << R"({"lights": [{"type": "sun", "name": "sky",
      "direction": [0, -1, 0], "irradiance": 3}]})";
  std::ofstream(path("at.csv")) << "x,y,z,nx,ny,nz\n0,90,0,0,1,0\n";
  const std::string points =
      "points 'scene:tree?leaves=10' --at at.csv --rays 1024 -o out.csv --lights suns.json ";
  const program_test::Outcome run = dapple(points + "--sky overcast");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err,
                       "note: sky_r, sky_g and sky_b are of --sky; the scene's own light of that "
                       "name has a number"))
      << run.err;
  for (const char* colour : {"r", "g", "b"}) {
    EXPECT_NEAR(value_of("out.csv", std::string("sky_") + colour), 1, 0.032);
    EXPECT_NEAR(value_of("out.csv", std::string("sky_2_") + colour), 3, 1e-5);
  }
  const program_test::Outcome alone = dapple(points);
  EXPECT_EQ(alone.code, 0);
  EXPECT_FALSE(contains(alone.err, "has a number")) << alone.err;
  EXPECT_NEAR(value_of("out.csv", "sky_r"), 3, 1e-5) << "there is no other";
}

}  // namespace
}  // namespace dapple
