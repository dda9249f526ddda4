// EXR files as OpenImageIO's oiiotool, another program, reads them: the commands of docs/layers.md,
// the names of channels and parts, and their values, which dapple's own reader has too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "film/exr/exr_parts.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

/// The commands of docs/layers.md that begin with "oiiotool", each in one line and without comment.
std::vector<std::string> documented_commands() {
  std::vector<std::string> commands;
  std::ifstream file(DAPPLE_SOURCE_FOLDER "/docs/layers.md");
  bool goes_on = false;
  for (std::string line; std::getline(file, line);) {
    if (!goes_on && !line.starts_with("oiiotool ")) continue;
    if (!goes_on) commands.emplace_back();
    goes_on = line.ends_with("\\");
    commands.back() += goes_on ? line.substr(0, line.size() - 1) : line.substr(0, line.find('#'));
  }
  return commands;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The bytes of a PNG: the curve of IEC 61966-2-1.
std::vector<float> srgb_bytes(const std::vector<float>& linear) {
  std::vector<float> bytes;
  for (const float value : linear) {
    const float v = std::clamp(value, 0.0f, 1.0f);
    const float coded = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
    bytes.push_back(std::round(255 * coded));
  }
  return bytes;
}

class OiioTool : public ProgramRun {
 protected:
  void SetUp() override {
    if (std::system("oiiotool --version >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "needs oiiotool (Debian: openimageio-tools)";
  }

  void render_tree(const std::string& options) const {
    const Outcome run = dapple(
        "render 'scene:tree?leaves=500' --width 16 --height 12 --spp 8 -q --report-bias 0 "
        "--passes ao,light,albedo,beauty,back,visits --cryptomatte object,material " +
        options);
    ASSERT_EQ(run.code, 0) << run.err;
  }
  void render_parts() const {
    render_tree("-o parts.exr --multipart --half all --compression dwaa");
  }

  /// Runs a command in the test's folder; returns what it printed.
  [[nodiscard]] std::string printed(const std::string& command) const {
    const std::string out = (logs() / "oiiotool").string();
    const std::string line = "cd '" + folder_.string() + "' && " + command + " >'" + out + "' 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0) << command << "\n" << bytes_of(out);
    return bytes_of(out);
  }

  /// What stands in the line of oiiotool's output that has `label`, after it.
  [[nodiscard]] std::string line_after(const std::string& label, const std::string& command) const {
    const std::string text = printed(command);
    const std::size_t at = text.find(label);
    EXPECT_NE(at, std::string::npos) << label << " is not in " << text;
    if (at == std::string::npos) return {};
    const std::size_t begin = at + label.size();
    return text.substr(begin, text.find('\n', begin) - begin);
  }

  [[nodiscard]] std::vector<std::string> channels_of(const std::string& file) const {
    std::istringstream line(line_after("channel list: ", "oiiotool --info -v " + file));
    std::vector<std::string> names;
    for (std::string name; std::getline(line >> std::ws, name, ',');) names.push_back(name);
    return names;
  }

  /// Of each channel, in the order of channels_of(). `name`: "Min", "Max" or "Avg".
  [[nodiscard]] std::vector<double> statistics_of(const std::string& file,
                                                  const std::string& name) const {
    std::istringstream line(line_after("Stats " + name + ":", "oiiotool --stats " + file));
    std::vector<double> numbers;
    for (double number = 0; line >> number;) numbers.push_back(number);
    return numbers;
  }

  /// sun.png is the layer light.sun of that file, in sRGB.
  void expect_sun(const std::string& file) const {
    const Film film = read_exr(path(file));
    const std::vector<double> means = statistics_of("sun.png", "Avg");
    ASSERT_EQ(means.size(), 3u);
    for (std::size_t c = 0; c < 3; ++c) {
      const Plane* plane = film.find(std::string("light.sun.") + "RGB"[c]);
      // A value between two bytes may be rounded to either.
      EXPECT_NEAR(means[c], mean(srgb_bytes(plane->pixels)), 0.1) << file << " " << plane->channel;
    }
  }
};

TEST_F(OiioTool, RunsTheCommandsOfTheDocuments) {
  render_tree("-o tree.exr --deep tree_deep.exr");
  render_parts();
  const std::vector<std::string> commands = documented_commands();
  ASSERT_GE(commands.size(), 5u);
  for (const std::string& command : commands) {
    std::filesystem::remove(path("sun.png"));
    EXPECT_EQ(contains(printed(command), "dapple:scene: \"scene:tree"), contains(command, "--info"))
        << command;
    if (contains(command, "-o sun.png"))
      expect_sun(contains(command, "--subimage") ? "parts.exr" : "tree.exr");
  }
  const std::vector<float> alpha = read_exr(path("alpha.exr")).find("A")->pixels;
  const std::vector<float> expected = read_exr(path("tree.exr")).find("A")->pixels;
  ASSERT_EQ(alpha.size(), expected.size());
  for (std::size_t p = 0; p < alpha.size(); ++p) EXPECT_NEAR(alpha[p], expected[p], 1e-5) << p;
  const Film tree = read_exr(path("tree.exr")), evening = read_exr(path("evening.exr"));
  for (const auto& [letter, dimmed] : {std::pair{"R", 0.5f}, {"G", 0.4f}, {"B", 0.3f}}) {
    const std::vector<float>& sun = tree.find(std::string("beauty.sun.") + letter)->pixels;
    const std::vector<float>& sky = tree.find(std::string("beauty.sky.") + letter)->pixels;
    const std::vector<float>& both = evening.find(letter)->pixels;
    for (std::size_t p = 0; p < both.size(); ++p)
      EXPECT_NEAR(both[p], dimmed * sun[p] + sky[p], 1e-5) << letter << p;
  }
}

TEST_F(OiioTool, NamesAllChannelsColoursFirstAndGivesTheirStatistics) {
  render_tree("-o tree.exr");
  const Film film = read_exr(path("tree.exr"));
  const std::vector<std::string> names = channels_of("tree.exr");
  ASSERT_EQ(names.size(), film.planes.size());
  EXPECT_EQ(std::vector(names.begin(), names.begin() + 4),
            (std::vector<std::string>{"R", "G", "B", "A"}));
  const std::vector<double> means = statistics_of("tree.exr", "Avg");
  const std::vector<double> largest = statistics_of("tree.exr", "Max");
  ASSERT_EQ(means.size(), names.size());
  ASSERT_EQ(largest.size(), names.size());
  for (std::size_t c = 0; c < names.size(); ++c) {
    const Plane* plane = film.find(names[c]);
    ASSERT_NE(plane, nullptr) << names[c];
    std::vector<float> finite;
    std::copy_if(plane->pixels.begin(), plane->pixels.end(), std::back_inserter(finite),
                 [](float value) { return std::isfinite(value); });
    // Six decimals are printed.
    EXPECT_NEAR(means[c], mean(finite), 1e-6 + 1e-6 * std::fabs(means[c])) << names[c];
    EXPECT_NEAR(largest[c], double{*std::max_element(finite.begin(), finite.end())}, 1e-6)
        << names[c];
  }
}

TEST_F(OiioTool, FindsEachPartByItsLayersNameWithItsValues) {
  render_parts();
  const Film film = read_exr(path("parts.exr"));
  std::set<std::string> layers;
  for (const Plane& plane : film.planes) layers.insert(layer_of(plane.channel));
  EXPECT_GT(layers.size(), 10u);
  std::string command = "oiiotool";
  // Compressed by ZIP, for dwaa would lose more.
  for (const std::string& layer : layers)
    command += " parts.exr --subimage " + layer + " --compression zip -o part." + layer + ".exr";
  EXPECT_EQ(printed(command), "");
  std::size_t channels = 0;
  for (const std::string& layer : layers) {
    for (const Plane& plane : read_exr(path("part." + layer + ".exr")).planes) {
      ASSERT_NE(film.find(plane.channel), nullptr) << plane.channel;
      EXPECT_EQ(layer_of(plane.channel), layer);
      EXPECT_EQ(bits_of(plane.pixels), bits_of(film.find(plane.channel)->pixels)) << plane.channel;
      ++channels;
    }
  }
  EXPECT_EQ(channels, film.planes.size());
}

}  // namespace
}  // namespace dapple
