// dapple merge as users call it: parts from renders of several processes, with other numbers of
// threads, are the file of one render byte for byte; what it refuses, and says.
#include <gtest/gtest.h>

#include <random>
#include <regex>

#include "files/exr_reader.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

const std::string kTree =
    "render 'scene:tree?leaves=1000' --width 40 --height 36 --spp 7 --passes ao,light,albedo,back "
    "--cryptomatte object --report-bias 0 -q ";

class MergeCommand : public ProgramRun {
 protected:
  [[nodiscard]] std::string bytes(const char* name) const { return bytes_of(path(name)); }
};

TEST_F(MergeCommand, ShardsOfOtherProcessesAreTheFileOfOneRender) {
  ASSERT_EQ(dapple(kTree + "-o whole.exr").code, 0);
  ASSERT_EQ(dapple(kTree + "--shard 1/3 -o a.dapple", "taskset -c 0").code, 0);
  ASSERT_EQ(dapple(kTree + "--shard 2/3 -o b.dapple").code, 0);
  ASSERT_EQ(dapple(kTree + "--shard 3/3 -o c.dapple").code, 0);
  const Outcome merge = dapple("merge c.dapple a.dapple b.dapple -o merged.exr --png merged.png");
  EXPECT_EQ(merge.code, 0) << merge.err;
  EXPECT_EQ(merge.out,
            "merged 3 parts, all of 7 samples per pixel; wrote merged.exr and merged.png\n");
  EXPECT_TRUE(bytes("merged.exr") == bytes("whole.exr"));
  const Outcome two = dapple("merge c.dapple a.dapple -o two.exr");
  EXPECT_EQ(two.code, 0);
  EXPECT_TRUE(contains(two.err, "note: parts are missing: samples 3 to 4 of 7")) << two.err;
  const Outcome quiet = dapple("merge c.dapple a.dapple -o two.exr -q");
  EXPECT_EQ(quiet.out, "");
  EXPECT_EQ(quiet.err, "note: parts are missing: samples 3 to 4 of 7\n");
  expect_failure(dapple("merge a.dapple b.dapple a.dapple -o no.exr"), 2,
                 "a.dapple is named twice: its samples 1 to 2");
  expect_failure(dapple("merge a.dapple -o a.dapple"), 2,
                 "would overwrite a.dapple, which is read");
  EXPECT_FALSE(std::filesystem::exists(path("no.exr")));
}

TEST_F(MergeCommand, ARenderGoesOnFromAMergeThatLacksNothing) {
  ASSERT_EQ(dapple(kTree + "--shard 1/2 -o a.dapple").code, 0);
  ASSERT_EQ(dapple(kTree + "--shard 2/2 -o b.dapple").code, 0);
  ASSERT_EQ(dapple("merge a.dapple b.dapple -o sum.dapple").code, 0);
  const std::string more = std::regex_replace(kTree, std::regex("--spp 7"), "--spp 14");
  const Outcome render = dapple(more + "--resume sum.dapple -o more.exr");
  ASSERT_EQ(render.code, 0) << render.err;
  const ExrImage image = ExrFile(path("more.exr")).image();
  for (const float samples : image.channels.at("samples")) EXPECT_EQ(samples, 14);
  ASSERT_EQ(dapple("merge b.dapple -o half.dapple").code, 0);
  expect_failure(dapple(more + "--resume half.dapple -o no.exr"), 2, "half.dapple");
}

/// A sky of random pixels, which lights a crop from another side than the whole image.
Film noisy_sky() {
  Film sky;
  sky.width = 8;
  sky.height = 4;
  sky.data_window = {0, 0, 7, 3};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> radiance(0.0f, 3.0f);
  for (const char* channel : {"R", "G", "B"}) {
    sky.planes.push_back({channel, std::vector<float>(32)});
    for (float& pixel : sky.planes.back().pixels) pixel = radiance(random);
  }
  return sky;
}

// Of the lamp the crops have other automatic ambients than the image: a merge chooses that of all.
TEST_F(MergeCommand, TilesOfCropsAreTheFileOfOneRenderWithADomeToo) {
  write_exr(noisy_sky(), path("sky.exr"));
  write_bytes(path("lamp.json"), R"({"lights": [{"type": "disk", "name": "lamp", "radius": 0.3,
      "position": [1, 2.5, 1.2], "normal": [-0.4, -1, -0.5], "radiance": [8, 8, 8]}]})");
  for (const std::string& options :
       {kTree, kTree + "--dome sky.exr ", kTree + "--lights lamp.json "}) {
    SCOPED_TRACE(options);
    ASSERT_EQ(dapple(options + "-o whole.exr").code, 0);
    ASSERT_EQ(dapple(options + "--crop 0,0,18,35 -o left.dapple").code, 0);
    ASSERT_EQ(dapple(options + "--crop 19,0,39,20 -o above.dapple").code, 0);
    ASSERT_EQ(dapple(options + "--crop 19,21,39,35 -o below.dapple").code, 0);
    const Outcome merge = dapple("merge below.dapple left.dapple above.dapple -o merged.exr");
    EXPECT_EQ(merge.code, 0) << merge.err;
    EXPECT_TRUE(bytes("merged.exr") == bytes("whole.exr"));
    const Outcome two = dapple("merge below.dapple left.dapple -o two.exr");
    EXPECT_EQ(two.code, 0) << two.err;
    EXPECT_TRUE(contains(two.err, "parts are missing: 441 of 1440 pixels")) << two.err;
    EXPECT_FALSE(bytes("two.exr") == bytes("whole.exr"));
  }
}

TEST_F(MergeCommand, PartsAreRefusedWhereTheyCannotBe) {
  expect_failure(dapple(kTree + "--shard 1/2 -o a.exr"), 2, "makes a part of an image");
  expect_failure(dapple(kTree + "--shard 2/1 -o a.dapple"), 2, "expected I/N with I from 1 to N");
  expect_failure(dapple(kTree + "--shard 2 -o a.dapple"), 2, "--shard 2: expected I/N, as in 2/8");
  expect_failure(dapple(kTree + "--shard 1/8 -o a.dapple"), 2, "--spp 7 makes at most 7 shards");
  expect_failure(dapple(kTree + "--shard 1/2 --target-rmse 0.1 -o a.dapple"), 2,
                 "--shard does not go with --target-rmse");
  expect_failure(dapple(kTree + "--target-error 0.1 -o a.dapple"), 2,
                 "give --spp in place of --target-error");
  expect_failure(dapple(kTree + "--max-bias 0.01 -o a.dapple"), 2, "--max-bias does not go with");
  expect_failure(dapple(kTree + "--half ao -o a.dapple"), 2, "give them to dapple merge");
  expect_failure(dapple(kTree + "--frames 1-2 --shard 1/2 -o a.#.dapple"), 2, "needs --ambient");
  expect_failure(dapple(kTree + "--frame 1 --shutter=0,0.5 -o a.dapple"), 2,
                 "--shutter does not go with --shard");
  expect_failure(dapple("merge no.dapple -o a.exr"), 3, "no.dapple: ");
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(MergeCommand, FramesAreShardsOfTheirOwn) {
  const std::string frames = kTree + "--frames 1-2 --ambient 0.2 ";
  ASSERT_EQ(dapple(frames + "-o whole.#.exr").code, 0);
  ASSERT_EQ(dapple(frames + "--shard 1/2 -o a.#.dapple").code, 0);
  ASSERT_EQ(dapple(frames + "--shard 2/2 -o b.#.dapple").code, 0);
  for (const std::string frame : {"1", "2"}) {
    ASSERT_EQ(dapple("merge a." + frame + ".dapple b." + frame + ".dapple -o m.exr -q").code, 0);
    EXPECT_TRUE(bytes("m.exr") == bytes_of(path("whole." + frame + ".exr"))) << frame;
  }
}

TEST_F(MergeCommand, StatisticsTellWhatPartsKnow) {
  ASSERT_EQ(dapple(kTree + "--shard 1/2 -o a.dapple").code, 0);
  ASSERT_EQ(dapple("merge a.dapple -o m.exr --stats-json m.json").code, 0);
  const std::string json = bytes("m.json");
  EXPECT_TRUE(contains(json, "\"parts\": 1")) << json;
  EXPECT_TRUE(contains(json, "\"missing\": \"")) << json;
  EXPECT_TRUE(contains(json, "\"estimator\": \"prefiltered\"")) << json;
  for (const char* unknown : {"triangles\":", "nodes\":", "kernel_build", "bvh"})
    EXPECT_FALSE(contains(json, unknown)) << unknown;
}

TEST_F(MergeCommand, PreviewsHaveTheHeatMapOfARender) {
  const std::string visits =
      "render 'scene:tree?leaves=1000' --width 40 --height 36 --spp 6 --passes ao,visits -q ";
  for (const char* shard : {"1", "2"})
    ASSERT_EQ(dapple(visits + "--shard " + shard + "/2 -o " + shard + ".dapple").code, 0);
  ASSERT_EQ(dapple("merge 1.dapple 2.dapple -o m.exr --png m.png").code, 0);
  // Not the render's: how many nodes a packet visits depends on the rays that it has.
  write_heat_map(read_exr(path("m.exr")), path("same.png"), "visits.nodes");
  EXPECT_EQ(bytes("m_visits.png"), bytes("same.png"));
  expect_failure(dapple("merge 1.dapple 2.dapple -o sum.dapple --half all"), 2, "--half");
  EXPECT_FALSE(std::filesystem::exists(path("sum.dapple")));
}

TEST_F(MergeCommand, PartsMayHaveTheirOpacitiesInAnotherOrder) {
  const std::string leaf = "--opacity leaf=0.5 ", bark = "--opacity bark=0.7 ";
  ASSERT_EQ(dapple(kTree + leaf + bark + "-o whole.exr").code, 0);
  ASSERT_EQ(dapple(kTree + leaf + bark + "--shard 1/2 -o a.dapple").code, 0);
  ASSERT_EQ(dapple(kTree + bark + leaf + "--shard 2/2 -o b.dapple").code, 0);
  const Film whole = read_exr(path("whole.exr"));
  for (const char* parts : {"a.dapple b.dapple", "b.dapple a.dapple"}) {
    SCOPED_TRACE(parts);
    const Outcome merge = dapple("merge " + std::string(parts) + " -o m.exr");
    ASSERT_EQ(merge.code, 0) << merge.err;
    const Film merged = read_exr(path("m.exr"));
    ASSERT_EQ(merged.planes.size(), whole.planes.size());
    for (const Plane& plane : whole.planes)
      EXPECT_EQ(bits_of(merged.find(plane.channel)->pixels), bits_of(plane.pixels))
          << plane.channel;
  }
}

}  // namespace
}  // namespace dapple
