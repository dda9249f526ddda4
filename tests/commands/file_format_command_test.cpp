// The options of the EXR file: what a render writes with them, and that a checkpoint, another
// render and `dapple compare` go with files written so. The name of the file of `dapple scene`.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "dapple/film.hpp"
#include "film/exr/exr_parts.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;

class FileFormatCommand : public program_test::ProgramRun {};

TEST_F(FileFormatCommand, CompareFindsLosslessFilesEqualAndHalvesNear) {
  ASSERT_EQ(render("-q").code, 0);
  std::filesystem::rename(path("out.exr"), path("float.exr"));
  for (const char* lossless :
       {"--compression piz", "--multipart", "--compression none --multipart"}) {
    ASSERT_EQ(render(std::string("-q ") + lossless).code, 0) << lossless;
    const auto run = dapple("compare out.exr float.exr --max-rmse 0");
    EXPECT_EQ(run.code, 0) << lossless << run.out << run.err;
  }
  ASSERT_EQ(render("-q --half ao,light --multipart").code, 0);
  EXPECT_EQ(dapple("compare out.exr float.exr --max-rmse 0").code, 5);
  // Values are below 4, so a half's step is at most 2^-9.
  EXPECT_EQ(dapple("compare out.exr float.exr --max-rmse 0.001").code, 0);
}

TEST_F(FileFormatCommand, ALayerThatTheFirstFileLacksIsTooLargeADifferenceWhereThereIsALimit) {
  ASSERT_EQ(render("-q").code, 0);
  std::filesystem::rename(path("out.exr"), path("whole.exr"));
  ASSERT_EQ(render("-q --passes ao").code, 0);
  const std::string compare = "compare out.exr whole.exr --layer albedo";
  EXPECT_EQ(dapple(compare + " --max-rmse 9").code, 5);
  EXPECT_EQ(dapple(compare).code, 2);
  EXPECT_EQ(dapple("compare out.exr whole.exr --layer nothing --max-rmse 9").code, 2);
}

TEST_F(FileFormatCommand, AResumedRenderWritesTheSameHalves) {
  ASSERT_EQ(render("-q --half all --multipart --checkpoint a.ckpt").code, 0);
  const std::string first = bytes_of(path("out.exr"));
  ASSERT_EQ(render("-q --half all --multipart --resume a.ckpt").code, 0);
  EXPECT_EQ(bytes_of(path("out.exr")), first);
}

TEST_F(FileFormatCommand, ANoteTellsOfHalfLayersThatTheImageDoesNotHave) {
  const auto run = render("--half ao,light.moon --passes ao");
  EXPECT_EQ(run.code, 0);
  EXPECT_TRUE(contains(run.err, "note: --half light.moon: there is no such layer")) << run.err;
  EXPECT_FALSE(contains(run.err, "--half ao")) << run.err;
}

TEST_F(FileFormatCommand, EveryLayerOfAPictureMayBeNamed) {
  const std::string picture =
      "render 'scene:tree?leaves=100' --width 16 --height 16 -q -o all.exr ";
  const std::string passes = "--passes ao,light,albedo,back,visits";
  std::set<std::string> layers;
  for (const char* more : {",motion --frame 0 --spp 4 --cryptomatte object,material",
                           " --target-error 0.5 --max-spp 16"}) {
    const auto run = dapple(picture + passes + more);
    ASSERT_EQ(run.code, 0) << run.err;
    for (const Plane& plane : read_exr(path("all.exr")).planes)
      layers.insert(layer_of(plane.channel));
  }
  EXPECT_GT(layers.size(), 18u);
  for (const std::string& layer : layers) {
    const auto run = dapple("render missing.glb -o o.exr --half " + layer);
    EXPECT_TRUE(run.code == 3 || contains(run.err, "stays 32-bit")) << layer << ": " << run.err;
  }
}

TEST_F(FileFormatCommand, ASceneIsWrittenOnlyToANameThatEndsInGlb) {
  for (const char* name : {"s.gltf", "s.GLTF", "s", "glb"})
    expect_failure(dapple("scene disk -o " + std::string(name)), 2,
                   "--output is " + std::string(name) + "; it must end in .glb");
  EXPECT_EQ(files_in_folder(), 0u);
  EXPECT_EQ(dapple("scene disk -o s.glb -q").code, 0);
  EXPECT_EQ(bytes_of(path("s.glb")).substr(0, 4), "glTF");
}

}  // namespace
}  // namespace dapple
