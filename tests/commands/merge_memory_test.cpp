// The memory of dapple merge does not grow with the number of parts: it holds the sums of the image
// and one part, so that a farm's image of a hundred shards is merged on any machine. All parts name
// the scene's materials; it holds these names once, too.
#include <gtest/gtest.h>

#include "dapple/render.hpp"
#include "support/files/film_files.hpp"
#include "support/programs/adoption.hpp"
#include "support/programs/running_program.hpp"
#include "support/sanitizers.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

constexpr int kWidth = 240, kHeight = 160;

/// Sums of a part that are unpacked: the image has more than 20 values of 8 bytes.
constexpr long kPartBytes = 20L * 8 * kWidth * kHeight;

/// A tree of two materials, and `more` that nothing has.
Scene tree_with_materials(int more) {
  Scene scene = make_procedural("scene:tree?leaves=300");
  for (int i = 0; i < more; ++i) {
    scene.materials.emplace_back();
    scene.materials.back().name = "a material of the scene's library, number " + std::to_string(i);
  }
  return scene;
}

class MergeMemory : public FilmFile {
 protected:
  /// Renders all shards of an image; returns their files.
  std::vector<std::string> shards(int count, const Scene& scene) {
    RenderOptions options;
    options.cryptomattes.materials = true;
    options.width = kWidth;
    options.height = kHeight;
    options.spp = 24;
    options.ao_rays = 1;
    options.report_bias = 0;
    std::vector<std::string> files;
    for (int i = 1; i <= count; ++i) {
      options.shard = {i, count};
      RenderControl control;
      control.part = path(std::to_string(count) + "_" + std::to_string(i) + ".dapple");
      renderer_.render(scene, options, control);
      files.push_back(control.part);
    }
    return files;
  }
  /// The most memory, in bytes, that a process needs to merge the parts. A shell starts it: the
  /// system counts the memory of the process that forks, too, and that of the tests is large.
  [[nodiscard]] long peak_bytes(const std::vector<std::string>& parts,
                                const std::string& output) const {
    const Adoption adoption;
    std::string command = DAPPLE_PROGRAM " merge -q -o '" + path(output) + "'";
    for (const std::string& part : parts) command += " '" + part + "'";
    command += " >'" + path("log") + "' 2>&1 & echo $! >'" + path("process") + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    const pid_t process = std::stoi(bytes_of(path("process")));
    int status = -1;
    rusage usage{};
    const auto has_ended = [&] { return wait4(process, &status, WNOHANG, &usage) != 0; };
    EXPECT_TRUE(wait_until(has_ended, kLongest));
    EXPECT_EQ(status, 0) << bytes_of(path("log"));
    return usage.ru_maxrss * 1024;
  }

 private:
  Renderer renderer_;
};

TEST_F(MergeMemory, DoesNotGrowWithTheNumberOfParts) {
  DAPPLE_SKIP_WITH_SANITIZER();  // freed memory is kept
  const Scene scene = tree_with_materials(0);
  const long two = peak_bytes(shards(2, scene), "two.exr");
  const long many = peak_bytes(shards(24, scene), "many.exr");
  EXPECT_TRUE(bytes_of(path("two.exr")) == bytes_of(path("many.exr")));
  EXPECT_GT(two, 2 * kPartBytes) << "the sums and a part are most of the memory";
  // 22 parts more, whose files alone are as large as the sums of one.
  EXPECT_LT(many, two + kPartBytes / 2) << "with 2 parts: " << two;
  std::printf("merging 2 parts took %ld MB, 24 parts %ld MB\n", two / 1000000, many / 1000000);
}

TEST_F(MergeMemory, HoldsNamesThatAllPartsHaveOnce) {
  DAPPLE_SKIP_WITH_SANITIZER();
  const Scene scene = tree_with_materials(20000);
  const long two = peak_bytes(shards(2, scene), "two.exr");
  const long many = peak_bytes(shards(24, scene), "many.exr");
  // The names of a part take 80 bytes each: 22 parts more would be 35 MB.
  EXPECT_LT(many, two + 12000000) << "with 2 parts: " << two;
  std::printf("merging 2 parts took %ld MB, 24 parts %ld MB\n", two / 1000000, many / 1000000);
}

}  // namespace
}  // namespace dapple
