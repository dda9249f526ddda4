// Child processes that compile kernels ahead (`dapple compile`). They compile every kernel, so that
// a picture has nothing left to compile. Where no process can be started, the picture is the same.
#include "device/programs/compiler_processes.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <set>

#include "dapple/device.hpp"
#include "dapple/error.hpp"
#include "device/cpus.hpp"
#include "device/environment_while.hpp"
#include "passes/kernel_list.hpp"
#include "passes/warm_up.hpp"
#include "support/programs/adoption.hpp"
#include "support/programs/program_run.hpp"
#include "support/programs/running_program.hpp"
#include "support/sanitizers.hpp"

namespace dapple {
namespace {

using namespace film_test;
using program_test::Milliseconds;
using program_test::Outcome;
using program_test::RunningProgram;

namespace fs = std::filesystem;

TEST(KernelText, IsReadBackAsItWasWritten) {
  std::set<std::string> texts;
  for (const KernelShape& shape : every_kernel(Device().context())) {
    const std::string text = text_of(shape.kernel);
    const KernelName read = parse_kernel(text);
    EXPECT_EQ(read.name, shape.kernel.name);
    EXPECT_EQ(read.file, shape.kernel.file);
    EXPECT_EQ(read.variant, shape.kernel.variant);
    EXPECT_TRUE(texts.insert(text).second) << text;
  }
}

TEST(KernelText, AnythingElseIsRefused) {
  for (const char* text :
       {"", "packet", "packet:packet:1", "packet:packet:1:0:", "packet:packet:1:x", "..:packet:1:0",
        "packet:..:1:0", " packet:packet:1:0"})
    EXPECT_THROW(parse_kernel(text), Error) << text;
}

/// Ids of the children of `process` that run `dapple compile` now.
std::set<std::string> compilers_now(pid_t process) {
  const std::string id = std::to_string(process);
  std::istringstream children(bytes_of("/proc/" + id + "/task/" + id + "/children"));
  std::set<std::string> compilers;
  const std::string begin("dapple\0compile\0", 15);
  for (std::string child; children >> child;)
    if (bytes_of("/proc/" + child + "/cmdline").starts_with(begin)) compilers.insert(child);
  return compilers;
}

class CompilingProcesses : public program_test::ProgramRun {
 protected:
  void SetUp() override {
    if (Device().info().platform != "Portable Computing Language")
      GTEST_SKIP() << "only PoCL's machine code is kept";
    if (!fs::exists("/proc/self/task/" + std::to_string(getpid()) + "/children"))
      GTEST_SKIP() << "this system does not tell of a process's children";
    if (cpus_of_process().size() < 2) GTEST_SKIP() << "one CPU compiles by itself";
  }
  [[nodiscard]] Outcome with_cache(const std::string& arguments,
                                   const std::string& before = "") const {
    return dapple(arguments, "POCL_CACHE_DIR='" + path("cache") + "' " + before);
  }
  /// Runs the program. Returns how many processes compiled kernels for it.
  [[nodiscard]] std::size_t compilers_of(const std::vector<std::string>& arguments) const {
    RunningProgram program(arguments, path("log"));
    std::set<std::string> compilers;
    while (!program.has_ended()) {
      compilers.merge(compilers_now(program.process()));
      std::this_thread::sleep_for(Milliseconds(10));
    }
    EXPECT_EQ(program.wait(), 0) << bytes_of(path("log"));
    return compilers.size();
  }
  /// Files of machine code in the cache: one for each program, kernel and size of work-groups.
  [[nodiscard]] std::set<std::string> machine_code() const {
    std::set<std::string> files;
    std::error_code ignored;
    for (const auto& entry : fs::recursive_directory_iterator(path("cache"), ignored))
      if (entry.path().extension() == ".so") files.insert(entry.path().string());
    return files;
  }
};

/// Tests that compile all kernels, or some kernels several times, which takes long.
class CompilingProcessesCold : public CompilingProcesses {};

TEST_F(CompilingProcessesCold, PicturesFindNothingLeftToCompile) {
  std::string kernels;
  for (const KernelShape& shape : every_kernel(Device().context()))
    kernels += " " + text_of(shape.kernel);
  const Outcome compiled = with_cache("compile" + kernels);
  ASSERT_EQ(compiled.code, 0) << compiled.err;
  const auto files = machine_code();
  EXPECT_EQ(files.size(), every_kernel(Device().context()).size());
  const std::string small = "--width 8 --height 8 ";
  for (const std::string& options :
       {small + "--passes ao,light", small + "--estimator exact --packets none",
        small + "--packets point --ao-rays 32", std::string("--width 257 --height 256")}) {
    const Outcome run = with_cache("render scene:cube -o out.exr --spp 1 " + options);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(machine_code(), files) << options;
  }
}

TEST(WarmUp, KnowsEveryKernel) {
  for (const KernelShape& shape : every_kernel(Device().context()))
    EXPECT_TRUE(can_warm_up(shape.kernel)) << shape.kernel.name;
}

TEST_F(CompilingProcesses, BuildingProgramsMakesNoMachineCode) {
  ASSERT_EQ(with_cache("compile --programs compact_hits:queue_kernels:0:0").code, 0);
  EXPECT_TRUE(machine_code().empty());
  EXPECT_FALSE(fs::is_empty(path("cache")));
  ASSERT_EQ(with_cache("compile compact_hits:queue_kernels:0:0").code, 0);
  EXPECT_EQ(machine_code().size(), 1u);
}

TEST_F(CompilingProcesses, APictureIsCompiledByProcesses) {
  const EnvironmentWhile cache("POCL_CACHE_DIR", path("cache"));
  EXPECT_GE(compilers_of({"render", "scene:cube", "-o", path("out.exr"), "--spp", "1", "-q"}), 2u);
}

TEST_F(CompilingProcessesCold, MachineCodeThatIsMissingIsMadeByProcessesToo) {
  const EnvironmentWhile cache("POCL_CACHE_DIR", path("cache"));
  std::vector<std::string> arguments{"render",   "scene:cube", "-o", path("out.exr"), "--passes",
                                     "ao",       "--spp",      "1",  "--width",       "8",
                                     "--height", "8",          "-q"};
  ASSERT_GE(compilers_of(arguments), 2u);
  EXPECT_EQ(compilers_of(arguments), 0u);
  arguments[5] = "ao,light";
  EXPECT_EQ(compilers_of(arguments), 2u) << "rays to the sun and to the sky, and resolving them";
}

TEST_F(CompilingProcesses, EndWithTheProcessThatWaitsForThem) {
  const EnvironmentWhile cache("POCL_CACHE_DIR", path("cache"));
  const program_test::Adoption adoption;
  RunningProgram program({"render", "scene:cube", "-o", path("out.exr"), "-q"}, path("log"));
  std::set<std::string> compilers;
  const auto are_there = [&] { return (compilers = compilers_now(program.process())).size() >= 2; };
  ASSERT_TRUE(program_test::wait_until(are_there, program_test::kLongest));
  program.send(SIGKILL);
  program.wait();
  // However busy the machine is, they have not ended by themselves.
  for (const std::string& id : compilers) {
    int status = 0;
    const auto has_ended = [&] { return waitpid(std::stoi(id), &status, WNOHANG) != 0; };
    EXPECT_TRUE(program_test::wait_until(has_ended, program_test::kLongest)) << id;
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << id << ": " << status;
  }
}

TEST_F(CompilingProcessesCold, WhereNoneCanBeStartedThePictureIsTheSame) {
  if (!program_test::has_namespaces()) GTEST_SKIP() << "no namespaces to mount in";
  DAPPLE_SKIP_WITH_SANITIZER();  // the search for leaks needs /proc
  // Compiler processes are started from /proc/self/exe, which is missing in this namespace.
  const std::string no_proc = program_test::in_namespace("mount -t tmpfs none /proc");
  for (const std::string packets : {"auto", "scalar"}) {
    const std::string picture =
        "render scene:cube --width 16 --height 16 --spp 4 -q --passes ao,light,visits --packets " +
        packets + " -o ";
    fs::remove_all(path("cache"));
    ASSERT_EQ(with_cache(picture + "with.exr").code, 0);
    const std::size_t kernels = machine_code().size();
    fs::remove_all(path("cache"));
    const Outcome run = with_cache(picture + "without.exr", no_proc);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(machine_code().size(), kernels) << packets << ": processes compile what is used";
    // Compares pixels and not the whole files: they contain the CPU's name, which comes from /proc.
    const Film with = read_exr(path("with.exr")), without = read_exr(path("without.exr"));
    for (const char* layer : {"ao.R", "light.sun.R", "light.sky.R", "visits.nodes"}) {
      ASSERT_NE(with.find(layer), nullptr) << layer;
      EXPECT_EQ(with.find(layer)->pixels, without.find(layer)->pixels) << layer;
    }
  }
}

}  // namespace
}  // namespace dapple
