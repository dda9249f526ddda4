// The option --cache of dapple render. The second run makes the same picture without building a
// BVH. The picture also stays the same with several processes at once, with damaged files, and
// after a process was killed while it built.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

namespace fs = std::filesystem;

class CacheCommand : public FilmFile {
 protected:
  CacheCommand() { fs::current_path(folder_); }
  ~CacheCommand() override { fs::current_path(before_); }

  /// A shell command that renders into NAME.exr, with statistics in NAME.json and the program's
  /// output in NAME.txt.
  static std::string command(const std::string& name, const std::string& scene = kScene) {
    return DAPPLE_PROGRAM " render '" + scene + "' -o " + name + ".exr --stats-json " + name +
           ".json --width 48 --height 32 --spp 2 --cache cache >" + name + ".txt 2>&1 </dev/null";
  }

  static int run(const std::string& shell) {
    const int status = std::system(shell.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  [[nodiscard]] nlohmann::json statistics(const std::string& name) const {
    return nlohmann::json::parse(bytes_of(path(name + ".json")));
  }

  void expect_same_picture(const std::string& a, const std::string& b) const {
    const Film x = read_exr(path(a + ".exr")), y = read_exr(path(b + ".exr"));
    ASSERT_EQ(x.planes.size(), y.planes.size());
    for (std::size_t i = 0; i < x.planes.size(); ++i) {
      EXPECT_TRUE(bits_of(x.planes[i].pixels) == bits_of(y.planes[i].pixels))
          << x.planes[i].channel;
    }
  }

  [[nodiscard]] std::vector<fs::path> cached_files() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(path("cache"))) files.push_back(entry.path());
    return files;
  }

  /// Whether there is a file in the cache that is not complete.
  [[nodiscard]] bool has_temporary_file() const {
    std::error_code ignored;  // the folder need not exist yet
    for (const auto& entry : fs::directory_iterator(path("cache"), ignored))
      if (entry.path().extension() == ".tmp") return true;
    return false;
  }

  fs::path before_ = fs::current_path();

  static constexpr const char* kScene = "scene:tree?leaves=20000";
};

TEST_F(CacheCommand, TheSecondRunBuildsNothingAndMakesTheSamePicture) {
  for (const char* scene : {kScene, "scene:forest?trees=9&leaves=500"}) {
    SCOPED_TRACE(scene);
    fs::remove_all(path("cache"));
    ASSERT_EQ(run(command("first", scene)), 0) << bytes_of(path("first.txt"));
    ASSERT_EQ(run(command("second", scene)), 0) << bytes_of(path("second.txt"));
    EXPECT_EQ(statistics("first")["bvh"], "built");
    EXPECT_GE(statistics("first")["cache"]["objects_written"], 1);
    EXPECT_EQ(statistics("second")["bvh"], "from cache");
    EXPECT_EQ(statistics("second")["cache"]["objects_read"],
              statistics("first")["cache"]["objects_written"]);
    EXPECT_EQ(statistics("second")["cache"]["objects_written"], 0);
    EXPECT_EQ(statistics("second")["nodes"], statistics("first")["nodes"]);
    EXPECT_TRUE(contains(bytes_of(path("second.txt")), "bvh: from cache"));
    expect_same_picture("first", "second");
  }
}

TEST_F(CacheCommand, AnotherCameraAndLightUseTheSameFiles) {
  write_bytes(
      path("lights.json"),
      R"({"lights": [{"name": "sun", "type": "sun", "direction": [0, -1, 0], "irradiance": 3}]})");
  ASSERT_EQ(run(command("first")), 0);
  ASSERT_EQ(run(DAPPLE_PROGRAM " render '" + std::string(kScene) +
                "' -o b.exr --stats-json b.json --width 16 --height 16 --spp 1 --cache cache -q "
                "--look-from 9,2,9 --look-at 0,1,0 --lights lights.json --estimator exact"),
            0);
  EXPECT_EQ(statistics("b")["bvh"], "from cache");
  EXPECT_EQ(cached_files().size(), 1u);
}

TEST_F(CacheCommand, ADamagedFileIsANoteAndTheSamePicture) {
  ASSERT_EQ(run(command("first")), 0);
  const fs::path file = cached_files().at(0);
  for (const std::size_t byte : {std::size_t{3}, std::size_t{2000}, fs::file_size(file) - 1}) {
    flip_bit(file.string(), 8 * byte + 5);
    ASSERT_EQ(run(command("second")), 0);
    EXPECT_EQ(statistics("second")["bvh"], "built");
    EXPECT_TRUE(contains(statistics("second")["notes"].dump(), file.filename().string()));
    EXPECT_TRUE(contains(bytes_of(path("second.txt")), "note: BVH cache: "));
    expect_same_picture("first", "second");
  }
  ASSERT_EQ(run(command("third")), 0);
  EXPECT_EQ(statistics("third")["bvh"], "from cache");
}

TEST_F(CacheCommand, TwoAtOnceMakeTheSamePictures) {
  ASSERT_EQ(run(command("a") + " & " + command("b") + " & wait"), 0);
  ASSERT_EQ(run(command("c")), 0);
  EXPECT_EQ(statistics("c")["bvh"], "from cache");
  EXPECT_EQ(cached_files().size(), 1u);
  expect_same_picture("a", "c");
  expect_same_picture("b", "c");
}

TEST_F(CacheCommand, AFolderThatCannotBeUsedIsFoundBeforeTheSceneIsRead) {
  write_bytes(path("cache"), "a file");
  EXPECT_EQ(run(command("a", "nosuch.glb")), 2);
  EXPECT_TRUE(contains(bytes_of(path("a.txt")), "--cache cache: it is not a folder"));
  EXPECT_EQ(bytes_of(path("cache")), "a file");
}

/// Starts a shell command in its own process group, and kills the whole group at that moment,
/// unless it ends before: also the compiler processes that the command may have started.
void kill_at(const std::string& shell, const std::function<bool()>& is_moment) {
  const pid_t child = fork();
  if (child == 0) {
    setpgid(0, 0);
    execl("/bin/sh", "sh", "-c", ("exec " + shell).c_str(), nullptr);
    _exit(127);
  }
  setpgid(child, child);  // here too, so that the group exists before it is killed
  siginfo_t ended{};
  while (ended.si_pid == 0 && !is_moment()) {
    usleep(100);
    waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
  }
  kill(-child, SIGKILL);
  waitpid(child, nullptr, 0);
}

TEST_F(CacheCommand, KilledBeforeItsFileIsCompleteTheNextRunCleansUpAndSucceeds) {
  const char* scene = "scene:tree?leaves=100000";
  ASSERT_EQ(run(command("first", scene)), 0);
  const auto json = statistics("first")["seconds"];
  const auto second = [&](const char* step) { return json[step].get<double>(); };
  // The process is not killed later: PoCL might then damage its compiled kernels on disk.
  const double built = second("load") + second("build") + second("prefilter") + second("cache");
  std::mt19937 random(2);
  std::uniform_real_distribution<double> moment(second("load"), built);
  int left = 0;
  for (int round = 0; round < 10; ++round) {
    fs::remove_all(path("cache"));
    const auto end = std::chrono::steady_clock::now() +
                     std::chrono::microseconds(static_cast<std::int64_t>(1e6 * moment(random)));
    kill_at(command("killed", scene), [&] {
      // Every second one while it writes its file, which takes many times as long as noticing it.
      return round % 2 == 0 ? std::chrono::steady_clock::now() >= end : has_temporary_file();
    });
    left += has_temporary_file() ? 1 : 0;
    ASSERT_EQ(run(command("next", scene)), 0) << bytes_of(path("next.txt"));
    expect_same_picture("first", "next");
    EXPECT_EQ(cached_files().size(), 1u);
    EXPECT_FALSE(contains(statistics("next")["notes"].dump(), "BVH cache"));
  }
  EXPECT_GE(left, 1) << "no process was killed while it wrote its file";
}

}  // namespace
}  // namespace dapple
