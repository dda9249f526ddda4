// The choice of a footprint scale, from a made-up bias that grows with the scale.
#include "sampling/footprint_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sampling/bias_estimate.hpp"

namespace dapple {
namespace {

/// The bias is 0.001 times the scale; its error falls with the number of rays.
class MadeUpBias : public BiasSource {
 public:
  explicit MadeUpBias(std::size_t most) : most_(most) {}
  void grow(std::size_t rays) override { rays_ = std::max(rays_, std::min(rays, most_)); }
  [[nodiscard]] bool is_complete() const override { return rays_ >= most_; }
  std::vector<Bias> bias(float footprint) override {
    const double mean = -0.001 * double{footprint};
    const double error = 0.2 / std::sqrt(static_cast<double>(rays_));
    return {{0, error, 0, 0, 1}, {mean, error, std::fabs(mean), std::fabs(mean), 1}};
  }
  [[nodiscard]] std::size_t rays() const { return rays_; }

 private:
  std::size_t most_, rays_ = 0;
};

TEST(FootprintChoice, TheLargestScaleWithLessBiasIsTaken) {
  MadeUpBias source(1u << 20);
  EXPECT_EQ(choose_footprint(source, {4, 0.01f, 0, true}).footprint, 4);
  EXPECT_EQ(choose_footprint(source, {4, 0.0025f, 0, true}).footprint, 2);
  EXPECT_EQ(choose_footprint(source, {4, 0.00145f, 0, true}).footprint, 1);
  EXPECT_EQ(choose_footprint(source, {4, 0.00001f, 0, true}).footprint, 0);
}

TEST(FootprintChoice, WhatFewRaysCannotShowIsNotTaken) {
  MadeUpBias source(1u << 12);  // an error of 0.003
  EXPECT_EQ(choose_footprint(source, {4, 0.005f, 0, true}).footprint, 0);
  EXPECT_EQ(choose_footprint(source, {4, 0.02f, 0, true}).footprint, 4);
}

TEST(FootprintChoice, TheNoteSaysWhatIsKnownAndWhy) {
  MadeUpBias many(1u << 20), few(1u << 12);
  const auto note = [](MadeUpBias& source, float most) {
    return choose_footprint(source, {4, most, 0, true}).note;
  };
  EXPECT_EQ(note(many, 0.01f).find("--max-bias 0.01: footprint 4, whose bias is at most 0.00"), 0u)
      << note(many, 0.01f);
  // The smallest footprint, 0.25, has a bias of 0.00025; its error is above 0.0002.
  EXPECT_NE(note(many, 0.00001f).find("too few rays to tell"), std::string::npos);
  EXPECT_NE(note(few, 0.005f)
                .find("too few rays to tell a bias so small (that of footprint 0.25 "
                      "may be 0.006"),
            std::string::npos)
      << note(few, 0.005f);
  const FootprintChoice hopeless = choose_footprint(many, {4000, 0.01f, 0, true});
  EXPECT_NE(hopeless.note.find("the bias of footprint 250 is at least 0.24"), std::string::npos)
      << hopeless.note;
}

TEST(FootprintChoice, ClearCasesNeedFewRays) {
  MadeUpBias clear(1u << 20), close(1u << 20);
  choose_footprint(clear, {4, 0.1f, 0, true});
  choose_footprint(close, {4, 0.0045f, 0, true});
  EXPECT_LT(clear.rays(), 40000u);
  EXPECT_GT(close.rays(), 4 * clear.rays());
}

TEST(FootprintChoice, ATargetAllowsHalfOfItAndTellsHowMuchThereIs) {
  MadeUpBias source(1u << 20);
  const FootprintChoice choice = choose_footprint(source, {4, 0, 0.005f, true});
  EXPECT_EQ(choice.footprint, 2);
  EXPECT_NEAR(choice.bias_rmse, 0.002, 1e-9);
  EXPECT_EQ(choose_footprint(source, {4, 0, 0.02f, true}).note, "");
  const FootprintChoice fixed = choose_footprint(source, {4, 0, 0.005f, false});
  EXPECT_EQ(fixed.footprint, 4);
  EXPECT_NEAR(fixed.bias_rmse, 0.004, 1e-9);
}

TEST(FootprintChoice, AFootprintThatIsKeptAndMissesTheTargetIsNoted) {
  MadeUpBias source(1u << 20);  // footprint 4: 0.004
  FootprintDemand demand{4, 0, 0.004f, false};
  EXPECT_EQ(choose_footprint(source, demand).footprint, 4);
  EXPECT_EQ(
      choose_footprint(source, demand)
          .note.find(
              "the target 0.004 cannot be reached with footprint 4, whose bias is about 0.004"),
      0u);
  demand.target = 0.005f;
  EXPECT_EQ(choose_footprint(source, demand).note, "") << "0.004^2 + 0.0025^2 < 0.005^2";
}

/// Bent normals, say: their bias is not measured.
class NoBias : public BiasSource {
 public:
  void grow(std::size_t) override {}
  [[nodiscard]] bool is_complete() const override { return true; }
  std::vector<Bias> bias(float) override { return {}; }
};

TEST(FootprintChoice, WithoutAMeasuredLayerTheNoteClaimsNoLimit) {
  NoBias source;
  const FootprintChoice choice = choose_footprint(source, {4, 0.01f, 0, true});
  EXPECT_EQ(choice.footprint, 4);
  EXPECT_EQ(choice.note,
            "--max-bias 0.01: footprint 4: nothing is seen whose bias could be measured");
}

TEST(FootprintChoice, ATargetTakesAFourthOfTheRaysWhereTheyTellTheBias) {
  MadeUpBias small(1u << 20), large(1u << 20);
  choose_footprint(small, {1, 0, 0.02f, true});
  choose_footprint(large, {9, 0, 0.02f, true});
  EXPECT_EQ(small.rays(), 4096u);
  EXPECT_EQ(large.rays(), 16250u);
}

// It takes at most 2^16 rays, which tell the bias to 0.0008; 2^12 tell it to 0.003.
TEST(FootprintChoice, IfOnlyWhatIsClearCountsFewRaysKeepTheScale) {
  const auto choose = [](std::size_t rays, float most) {
    MadeUpBias source(rays);
    return choose_footprint(source, {4, most, 0, true, true});
  };
  EXPECT_EQ(choose(1u << 20, 0.005f).footprint, 4);
  EXPECT_EQ(choose(1u << 20, 0.005f).note, "");
  EXPECT_EQ(choose(1u << 12, 0.0022f).footprint, 4);
  EXPECT_LT(choose(1u << 20, 0.0022f).footprint, 4);
}

TEST(FootprintChoice, IfItIsClearHalfOfTheBiasIsLeft) {
  const auto choose = [](float footprint, float most) {
    MadeUpBias source(1u << 20);
    return choose_footprint(source, {footprint, most, 0, true, true});
  };
  EXPECT_EQ(choose(4, 0.0022f).footprint, 1);
  EXPECT_EQ(choose(4, 0.0001f).footprint, 0.25f) << "0.0003 is not clearly above 0.00005";
  EXPECT_EQ(choose(80, 0.005f).footprint, 0) << "a sixteenth still has 0.005";
  EXPECT_EQ(
      choose(4, 0.0022f).note,
      "footprint 1 in place of footprint 4, whose bias is about -0.0040; --max-bias 0 keeps that");
}

}  // namespace
}  // namespace dapple
