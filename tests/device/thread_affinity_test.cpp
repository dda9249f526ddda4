// The CPUs on which PoCL's threads may run. Another process reads them from /proc during a render.
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <fstream>

#include "device/cpus.hpp"
#include "device/environment_while.hpp"
#include "support/files/film_files.hpp"
#include "support/programs/running_program.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

/// The CPUs on which each thread of a process may run, as /proc writes them: "0-3,6".
std::vector<std::string> cpus_of_threads(pid_t process) {
  std::vector<std::string> cpus;
  std::error_code ignored;
  const std::string tasks = "/proc/" + std::to_string(process) + "/task";
  for (const auto& task : std::filesystem::directory_iterator(tasks, ignored)) {
    std::ifstream status(task.path() / "status");
    const std::string label = "Cpus_allowed_list:\t";
    for (std::string line; std::getline(status, line);)
      if (line.starts_with(label)) cpus.push_back(line.substr(label.size()));
  }
  return cpus;
}

class ThreadAffinity : public FilmFile {
 protected:
  ~ThreadAffinity() override { std::filesystem::remove(log()); }

  void SetUp() override {
    const std::vector<int> ours = cpus_of_process();
    cpus_ = static_cast<int>(ours.size());
    if (cpus_ < 2 || cpus_ != sysconf(_SC_NPROCESSORS_ONLN) || ours.back() != cpus_ - 1)
      GTEST_SKIP() << "needs all of several CPUs";
    if (std::getenv("POCL_AFFINITY") || std::getenv("POCL_MAX_PTHREAD_COUNT"))
      GTEST_SKIP() << "somebody has decided already";
  }
  /// Renders a picture. Returns the CPUs of the threads that may run on only one CPU, sorted.
  [[nodiscard]] std::vector<std::string> taken_cpus() const {
    RunningProgram program({"render", "scene:cube", "-o", path("out.exr"), "--spp", "1048576",
                            "--checkpoint", path("a.ckpt"), "--checkpoint-every", "0.05"},
                           log());
    const auto is_tracing = [&] { return std::filesystem::exists(path("a.ckpt")); };
    EXPECT_TRUE(wait_until(is_tracing, kLongest)) << bytes_of(log());
    std::vector<std::string> taken = cpus_of_threads(program.process());
    std::erase_if(taken, [](const std::string& cpus) {
      return cpus.find_first_of(",-") != std::string::npos;
    });
    std::sort(taken.begin(), taken.end());
    std::filesystem::remove(path("a.ckpt"));
    return taken;
  }
  /// The log is not in the folder, so that it does not count as a file left behind.
  [[nodiscard]] std::string log() const { return folder_.string() + ".log"; }

  int cpus_ = 0;
};

TEST_F(ThreadAffinity, EachThreadHasACpuOfItsOwn) {
  std::vector<std::string> every;
  for (int cpu = 0; cpu < cpus_; ++cpu) every.push_back(std::to_string(cpu));
  std::sort(every.begin(), every.end());
  EXPECT_EQ(taken_cpus(), every);
}

TEST_F(ThreadAffinity, FewerThreadsThanCpusRunWhereTheSystemPutsThem) {
  const EnvironmentWhile fewer("POCL_MAX_PTHREAD_COUNT", std::to_string(cpus_ - 1));
  EXPECT_EQ(taken_cpus(), std::vector<std::string>{});
}

TEST_F(ThreadAffinity, AVariableThatIsSetDecides) {
  const EnvironmentWhile refused("POCL_AFFINITY", "0");
  EXPECT_EQ(taken_cpus(), std::vector<std::string>{});
}

TEST_F(ThreadAffinity, AProcessThatHasNotAllCpusLeavesThemToTheSystem) {
  cpu_set_t all, fewer;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  fewer = all;
  CPU_CLR(0, &fewer);
  ASSERT_EQ(sched_setaffinity(0, sizeof fewer, &fewer), 0);
  const std::vector<std::string> taken = taken_cpus();
  ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
  // With two CPUs, one remains, and all threads share it.
  if (cpus_ > 2) {
    EXPECT_EQ(taken, std::vector<std::string>{});
  }
  EXPECT_EQ(std::count(taken.begin(), taken.end(), "0"), 0);
}

}  // namespace
}  // namespace dapple
