// RenderControl::warn: who renders is told while the work goes on that a checkpoint cannot be
// written, once, and again only after one could be written.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "dapple/render.hpp"
#include "dapple/scene.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

class CheckpointWarning : public FilmFile {
 protected:
  CheckpointWarning() {
    control_.checkpoint = path("folder/a.ckpt");
    control_.checkpoint_every = 0;  // after every slice
    control_.stop = [this] {
      ++slices_;
      if (slices_ == appears_) std::filesystem::create_directory(path("folder"));
      if (slices_ == vanishes_) std::filesystem::remove_all(path("folder"));
      return slices_ == stops_;
    };
    control_.warn = [this](const std::string& reason) {
      reasons_.push_back(reason);
      last_warning_ = slices_;
    };
  }

  RenderResult draw() {
    RenderOptions options;
    options.width = 40;
    options.height = 36;
    options.spp = 40;
    options.ao_rays = 32;  // slices have 8,192 samples: there are eight
    options.report_bias = 0;
    RenderResult result = render(make_procedural("scene:tree?leaves=1000"), options, control_);
    EXPECT_GE(slices_, 6);
    for (const std::string& reason : reasons_)
      EXPECT_TRUE(contains(reason, path("folder/a.ckpt"))) << reason;
    return result;
  }

  RenderControl control_;
  int appears_ = 0, vanishes_ = 0, stops_ = 0;  ///< the folder: at which slice; 0: at none
  int slices_ = 0, last_warning_ = 0;
  std::vector<std::string> reasons_;
};

TEST_F(CheckpointWarning, ComesOnceAndEarlyWhereNoCheckpointCanBeWritten) {
  const RenderResult result = draw();
  ASSERT_EQ(reasons_.size(), 1u);
  EXPECT_LT(last_warning_, slices_) << "the render went on";
  EXPECT_EQ(result.checkpoint_failure, reasons_[0]);
  EXPECT_FALSE(result.interrupted);
}

TEST_F(CheckpointWarning, ComesAgainAfterACheckpointCouldBeWritten) {
  appears_ = 3;
  vanishes_ = 5;
  const RenderResult result = draw();
  EXPECT_EQ(reasons_.size(), 2u);
  EXPECT_GE(last_warning_, vanishes_);
  EXPECT_FALSE(result.checkpoint_failure.empty());
}

TEST_F(CheckpointWarning, DoesNotComeWhereEachCheckpointIsWritten) {
  std::filesystem::create_directory(path("folder"));
  const RenderResult result = draw();
  EXPECT_TRUE(reasons_.empty()) << reasons_[0];
  EXPECT_EQ(result.checkpoint_failure, "");
}

TEST_F(CheckpointWarning, DoesNotComeOfTheLastCheckpointWhichTheResultTellsOf) {
  std::filesystem::create_directory(path("folder"));
  vanishes_ = stops_ = 6;
  const RenderResult result = draw();
  EXPECT_TRUE(result.interrupted);
  EXPECT_TRUE(reasons_.empty()) << reasons_[0];
  EXPECT_TRUE(contains(result.checkpoint_failure, path("folder/a.ckpt")));
}

}  // namespace
}  // namespace dapple
