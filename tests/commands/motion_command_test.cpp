// The options --passes motion and --shutter of dapple render, with --frame, --frames and --fps: a
// parallel camera sees a square that moves at 1 m/s. The motion vectors are compared with its way
// in a frame, and an open shutter with stills at the moments that it must sample.
#include <Imath/ImathVec.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/files/gltf_builder.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;
using Imath::V2d;

constexpr int kWidth = 64, kHeight = 48, kSpp = 16;
constexpr double kPixels = 40;  // of a metre
constexpr int kSide = 20;       // of the square, pixels

/// Middle of the square at `seconds`, from 0 to 2: pixels right and up from that of the picture. It
/// moves to the right and down, and from 1 s on to the left and down. At every eighth of a second
/// it is at whole pixels: its edges lie between pixels.
V2d middle_at(double seconds) {
  const double before = std::min(seconds, 1.0) - 1, after = std::max(seconds, 1.0) - 1;
  return (V2d(0.8, -0.6) * before + V2d(-0.6, -0.8) * after) * kPixels;
}

/// Mean position of what the picture shows, as of middle_at().
V2d middle_of(const Film& film) {
  const std::vector<float>& alpha = film.find("A")->pixels;
  V2d sum(0, 0);
  double weight = 0;
  for (int p = 0; p < kWidth * kHeight; ++p) {
    const double a = double{alpha[static_cast<std::size_t>(p)]};
    sum += a * V2d(p % kWidth + 0.5 - kWidth / 2, kHeight / 2 - 0.5 - p / kWidth);
    weight += a;
  }
  return sum / weight;
}

// Where the edges lie between pixels, only rounding may put a sample on the wrong side of one: one
// of the square's 20 * 20 * 16, 10 pixels aside, moves its middle by 0.002. A parallel camera's
// motion vectors are the same all over the square, and rounded by less.
void expect_near(const V2d& seen, const V2d& expected) {
  constexpr double kTolerance = 0.01;  // pixels
  EXPECT_NEAR(seen.x, expected.x, kTolerance);
  EXPECT_NEAR(seen.y, expected.y, kTolerance);
}

/// `expected`: of every point of the square, pixels right and up.
void expect_vectors(const Film& film, const V2d& expected) {
  ASSERT_TRUE(film.find("motion.X") && film.find("motion.Y"));
  const auto &x = film.find("motion.X")->pixels, &y = film.find("motion.Y")->pixels,
             &alpha = film.find("A")->pixels;
  int covered = 0;
  for (std::size_t p = 0; p < alpha.size(); ++p) {
    if (alpha[p] < 1) continue;
    ++covered;
    expect_near({double{x[p]}, double{y[p]}}, expected);
  }
  EXPECT_GT(covered, 50);
}

class MotionCommand : public ProgramRun {
 protected:
  MotionCommand() {
    test::GltfBuilder b;
    const auto half = static_cast<float>(kSide / 2 / kPixels);
    const int square = b.add_mesh(
        {{"attributes",
          {{"POSITION", b.add_positions({-half, -half, 0, half, -half, 0, half, half, 0, -half,
                                         -half, 0, half, half, 0, -half, half, 0})}}}});
    b.add("cameras", {{"type", "orthographic"},
                      {"orthographic",
                       {{"xmag", kWidth / 2 / kPixels},
                        {"ymag", kHeight / 2 / kPixels},
                        {"znear", 0.1},
                        {"zfar", 10}}}});
    b.add("nodes", {{"translation", {0, 0, 3}}, {"camera", 0}});
    b.add_movement(square, {0, 1, 2}, {-0.8f, 0.6f, 0, 0, 0, 0, -0.6f, -0.8f, 0});
    write("square.glb", b.glb());
  }

  void render_to(const std::string& output, const std::string& options) const {
    const Outcome run =
        dapple(fmt::format("render square.glb --width {} --height {} --spp {} -q -o {} {}", kWidth,
                           kHeight, kSpp, output, options));
    ASSERT_EQ(run.code, 0) << run.err;
  }
  [[nodiscard]] Film film(const std::string& options) const {
    render_to("a.exr", options);
    return read_exr(path("a.exr"));
  }

  /// Writes still.5.exr, still.7.exr, still.9.exr and still.11.exr: of so many eighths of a second.
  void render_stills() const { render_to("still.#.exr", "--passes ao --frames 5-11:2 --fps 8"); }

  /// Of an open shutter with these two moments, in eighths of a second.
  void expect_mean_of_stills(const Film& open, int first, int second) const {
    const auto still = [&](int eighths) {
      const Film film = read_exr(path(fmt::format("still.{}.exr", eighths)));
      expect_near(middle_of(film), middle_at(eighths / 8.0));
      return film;
    };
    const Film a = still(first), b = still(second);
    expect_near(middle_of(open), (middle_of(a) + middle_of(b)) / 2);
    const auto alpha = [](const Film& film, std::size_t p) { return film.find("A")->pixels[p]; };
    for (std::size_t p = 0; p < open.find("A")->pixels.size(); ++p)
      EXPECT_NEAR(alpha(open, p), (alpha(a, p) + alpha(b, p)) / 2, 1.0 / kSpp) << p;
  }
};

TEST_F(MotionCommand, VectorsAreTheWayUntilOneFrameLater) {
  struct Case {
    double seconds;
    const char* fps;
    double next_seconds;
  };
  // Before the square turns, after it has turned, and while it does; the last with 24 frames/s.
  for (const auto& [seconds, fps, next] :
       {Case{0.5, "--fps 5", 0.7}, Case{1.25, "--fps 10", 1.35}, Case{0.875, "--fps 4", 1.125},
        Case{0.5, "", 0.5 + 1.0 / 24}}) {
    SCOPED_TRACE(fmt::format("{} s {}", seconds, fps));
    const Film seen = film(fmt::format("--passes motion --frame {} {}", seconds, fps));
    expect_near(middle_of(seen), middle_at(seconds));
    expect_vectors(seen, middle_at(next) - middle_at(seconds));
  }
}

TEST_F(MotionCommand, VectorsOfASequenceLeadToItsNextFrame) {
  render_to("a.#.exr", "--passes motion --frames 7-8 --fps 8");
  const Film first = read_exr(path("a.7.exr")), second = read_exr(path("a.8.exr"));
  expect_near(middle_of(first), middle_at(0.875));
  expect_vectors(first, middle_of(second) - middle_of(first));
  expect_vectors(second, middle_at(1.125) - middle_at(1));
}

TEST_F(MotionCommand, VectorsOfAShutterAreTheMeanOfThoseOfItsMoments) {
  const Film seen = film("--passes motion --frame 0.75 --fps 2 --shutter 0,1 --motion-samples 2");
  const V2d first = middle_at(1.375) - middle_at(0.875),
            second = middle_at(1.625) - middle_at(1.125);
  expect_vectors(seen, (first + second) / 2);
}

TEST_F(MotionCommand, AShutterShowsTheMeanOfStillsInTheMiddlesOfItsParts) {
  struct Case {
    const char* options;
    int first, second;  ///< moments, eighths of a second
  };
  render_stills();
  for (const auto& [options, first, second] :
       {Case{"--shutter 0,1 --fps 2", 9, 11}, Case{"--shutter=-1,0 --fps 2", 5, 7},
        Case{"--shutter=-0.5,0.5 --fps 2", 7, 9}, Case{"--shutter 0,2 --fps 4", 9, 11}}) {
    SCOPED_TRACE(options);
    expect_mean_of_stills(film(std::string("--passes ao --frame 1 --motion-samples 2 ") + options),
                          first, second);
  }
}

TEST_F(MotionCommand, TheShutterOfASequenceOpensAtEachFrame) {
  render_stills();
  render_to("a.#.exr", "--passes ao --frames 1-2 --fps 2 --shutter 0,1 --motion-samples 2");
  expect_mean_of_stills(read_exr(path("a.1.exr")), 5, 7);
  expect_mean_of_stills(read_exr(path("a.2.exr")), 9, 11);
}

}  // namespace
}  // namespace dapple
