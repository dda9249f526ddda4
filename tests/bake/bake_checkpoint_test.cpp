// Checkpoints of bakes: a bake that is stopped and resumed has the bits of one that is not, and
// what does not belong together is refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "dapple/bake.hpp"
#include "dapple/error.hpp"
#include "support/files/film_files.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

class BakeCheckpoints : public film_test::FilmFile {
 protected:
  [[nodiscard]] RenderControl saving() const {
    RenderControl control;
    control.checkpoint = path("b.ckpt");
    control.checkpoint_every = 0;
    return control;
  }

  /// Bakes until the third question whether to stop, after two batches of samples.
  [[nodiscard]] BakeResult begin(const Scene& scene, const BakeOptions& options) const {
    RenderControl control = saving();
    int questions = 0;
    control.stop = [&] { return ++questions == 3; };
    return bake(scene, options, control);
  }

  /// A folder with a kernel file that is longer by a comment.
  [[nodiscard]] std::string other_kernels() const {
    const std::filesystem::path ao = folder_ / "kernels/occlusion/ao.cl";
    std::filesystem::create_directories(ao.parent_path());
    std::filesystem::copy_file(DAPPLE_SOURCE_FOLDER "/kernels/occlusion/ao.cl", ao);
    std::ofstream(ao, std::ios::app) << "/* another */\n";
    return path("kernels");
  }
  [[nodiscard]] BakeResult resume(const Scene& scene, const BakeOptions& options) const {
    RenderControl control = saving();
    control.resume = control.checkpoint;
    return bake(scene, options, control);
  }
};

BakeOptions all_passes() {
  BakeOptions options;
  options.bent = true;
  options.light = true;
  options.lights.emplace(1);
  options.lights->front().kind = LightKind::sun;
  options.texture = true;
  options.texture_size = 128;
  options.instances = true;
  return options;
}

TEST_F(BakeCheckpoints, AResumedBakeHasTheBitsOfOneThatWasNotInterrupted) {
  const Scene tree = make_procedural("scene:tree?leaves=100");
  const BakeOptions options = all_passes();
  const BakeResult whole = bake(tree, options);
  const BakeResult stopped = begin(tree, options);
  EXPECT_TRUE(stopped.interrupted);
  const BakeResult resumed = resume(tree, options);
  EXPECT_FALSE(resumed.interrupted);
  for (std::size_t m = 0; m < whole.meshes.size(); ++m) {
    EXPECT_EQ(resumed.meshes[m].ao, whole.meshes[m].ao);
    EXPECT_EQ(resumed.meshes[m].bent, whole.meshes[m].bent);
    EXPECT_EQ(resumed.meshes[m].light, whole.meshes[m].light);
  }
  EXPECT_EQ(resumed.texture.ao, whole.texture.ao);
  EXPECT_EQ(resumed.texture.light, whole.texture.light);
  EXPECT_EQ(resumed.instance_ao, whole.instance_ao);
  EXPECT_EQ(resumed.instance_light, whole.instance_light);
  EXPECT_EQ(resumed.statistics.rays, whole.statistics.rays);
  EXPECT_EQ(resumed.statistics.squared_errors, whole.statistics.squared_errors);
  ASSERT_FALSE(resumed.statistics.notes.empty());
  EXPECT_NE(resumed.statistics.notes.back().find("went on from"), std::string::npos);
}

// Those of many rays take long: who counts the questions, as the program does, knows after the
// second one that there is something to save.
TEST_F(BakeCheckpoints, ItAsksWhetherToStopBeforeTheFirstSamples) {
  RenderControl control = saving();
  control.stop = [] { return true; };
  const BakeResult stopped = bake(make_procedural("scene:tree?leaves=100"), {}, control);
  EXPECT_TRUE(stopped.interrupted);
  EXPECT_EQ(stopped.statistics.points, 0u);
}

TEST_F(BakeCheckpoints, AFinishedBakeIsReadWithoutTracing) {
  const Scene tree = make_procedural("scene:tree?leaves=100");
  const BakeResult whole = bake(tree, {}, saving());
  const BakeResult again = resume(tree, {});
  EXPECT_EQ(again.meshes.at(0).ao, whole.meshes.at(0).ao);
  const std::string all = std::to_string(whole.statistics.points);
  EXPECT_NE(again.statistics.notes.back().find(all + " of " + all + " points"), std::string::npos)
      << again.statistics.notes.back();
}

TEST_F(BakeCheckpoints, OtherOptionsAndScenesAreRefused) {
  const Scene tree = make_procedural("scene:tree?leaves=100");
  bake(tree, {}, saving());
  BakeOptions other;
  other.seed = 1;
  const auto refused = [&](const Scene& scene, const BakeOptions& options) -> std::string {
    try {
      (void)resume(scene, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "nothing was refused";
  };
  EXPECT_NE(refused(tree, other).find("--seed 0, this run has --seed 1"), std::string::npos);
  other = {};
  other.normals = Normals::geometric;
  EXPECT_NE(refused(tree, other).find("--normals shading, this run has --normals geometric"),
            std::string::npos);
  Scene moved = tree;
  moved.meshes.at(0).positions.at(0).x += 1;
  EXPECT_NE(refused(moved, {}).find("in scene"), std::string::npos);
  other = {};
  other.kernel_dir = other_kernels();
  EXPECT_NE(refused(tree, other).find("in kernels"), std::string::npos);
}

TEST_F(BakeCheckpoints, DamagedAndMissingFilesAreNamed) {
  const Scene tree = make_procedural("scene:tree?leaves=100");
  EXPECT_THROW((void)resume(tree, {}), Error);
  bake(tree, {}, saving());
  const auto size = std::filesystem::file_size(path("b.ckpt"));
  std::filesystem::resize_file(path("b.ckpt"), size - 1);
  try {
    (void)resume(tree, {});
    FAIL() << "a damaged file was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failed);
    EXPECT_NE(std::string(error.what()).find("b.ckpt"), std::string::npos) << error.what();
  }
}

TEST_F(BakeCheckpoints, ACheckpointThatCannotBeWrittenIsSaidAndTheBakeIsWhole) {
  const Scene tree = make_procedural("scene:tree?leaves=100");
  RenderControl control = saving();
  control.checkpoint = path("missing/b.ckpt");
  const BakeResult result = bake(tree, {}, control);
  EXPECT_NE(result.checkpoint_failure.find("missing/b.ckpt"), std::string::npos);
  EXPECT_FALSE(result.interrupted);
  EXPECT_EQ(result.meshes.at(0).ao, bake(tree, {}).meshes.at(0).ao);
}

}  // namespace
}  // namespace dapple
