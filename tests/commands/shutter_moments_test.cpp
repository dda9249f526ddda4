// The moments of an open shutter without --motion-samples: how many there are for a number of
// samples, and the note where they do not have as many samples each. A tree sways in the wind.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "dapple/film.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using program_test::Outcome;

class ShutterMoments : public program_test::ProgramRun {
 protected:
  [[nodiscard]] Outcome open(int spp, const std::string& options, const char* output) const {
    return dapple(
        fmt::format("render 'scene:tree?leaves=200&wind=1' --width 16 --height 9 --spp {} "
                    "--frame 1 --fps 2 --shutter 0,1 --passes ao -o {} {}",
                    spp, output, options));
  }
  /// Whether the pictures have the same bits in all layers.
  [[nodiscard]] bool same(const char* a, const char* b) const {
    const Film first = read_exr(path(a)), second = read_exr(path(b));
    EXPECT_EQ(first.planes.size(), second.planes.size());
    for (const Plane& plane : first.planes)
      if (bits_of(plane.pixels) != bits_of(second.find(plane.channel)->pixels)) return false;
    return true;
  }
};

// The picture is that of so many moments, and not of another number.
TEST_F(ShutterMoments, AreTheMostFromFourToEightThatDivideTheSamples) {
  struct Case {
    int spp, moments;
  };
  for (const auto& [spp, moments] : {Case{12, 6}, Case{10, 5}, Case{16, 8}, Case{11, 8}}) {
    ASSERT_EQ(open(spp, "-q", "default.exr").code, 0);
    for (const int others : {5, 6, 8}) {
      ASSERT_EQ(open(spp, fmt::format("-q --motion-samples {}", others), "given.exr").code, 0);
      EXPECT_EQ(same("default.exr", "given.exr"), others == moments)
          << spp << " samples, " << others << " moments";
    }
  }
}

TEST_F(ShutterMoments, OfOtherNumbersOfSamplesAreNotedAndOfEqualOnesAreNot) {
  const auto noted = [&](int spp, const char* options) {
    const Outcome run = open(spp, options, "a.exr");
    EXPECT_EQ(run.code, 0) << run.err;
    return contains(run.err, "moments of the shutter have") ? run.err : "";
  };
  const std::string uneven =
      "note: some of the 8 moments of the shutter have 1 samples a pixel, others 2, which weigh "
      "more; --spp 16 gives all as many\n";
  EXPECT_TRUE(contains(noted(11, ""), uneven));
  EXPECT_TRUE(contains(noted(12, "--motion-samples 8"), uneven));
  EXPECT_TRUE(contains(noted(13, "--motion-samples 5"),
                       "5 moments of the shutter have 2 samples a pixel, others 3"));
  for (const int spp : {10, 12, 16, 3}) EXPECT_EQ(noted(spp, ""), "") << spp;
  EXPECT_EQ(noted(16, "--motion-samples 2"), "");
  EXPECT_EQ(noted(11, "--motion-samples 11"), "");
}

}  // namespace
}  // namespace dapple
