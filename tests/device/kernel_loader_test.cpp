// Kernels that are loaded on another thread: those that are compiled need their source no more,
// others are left for later.
#include "device/programs/kernel_loader.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "dapple/error.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;

namespace fs = std::filesystem;

const KernelName kCount{"count_up", "", {}};

class LoadingKernels : public FilmFile {
 protected:
  /// `comment`: makes it another source.
  void write_source(const std::string& comment) const {
    fs::create_directories(path("kernels"));
    write_bytes(source(), "/* " + comment +
                              " */\n__kernel void count_up(__global uint* count) {\n" +
                              "  *count += 1;\n}\n");
  }
  [[nodiscard]] fs::path source() const { return path("kernels/count_up.cl"); }

  /// Compiles the kernel, and loads `lists` one after the other in another context.
  void expect_loaded_by(const std::vector<std::vector<KernelName>>& lists) const {
    write_source("compiled");
    {
      DeviceContext context("", path("kernels"));
      if (!context.keeps_compiled()) GTEST_SKIP() << "compiled kernels are not kept";
      context.launch(kCount, "count", 1, {context.allocate_zeros(4)}, 1);
      context.finish();
    }
    DeviceContext context("", path("kernels"));
    KernelLoader loader(context);
    for (const std::vector<KernelName>& list : lists) loader.start(list);
    loader.wait();
    fs::remove(source());
    EXPECT_GE(context.largest_group(kCount), 1u);
  }
};

TEST_F(LoadingKernels, CompiledOnesAreThereWithoutTheirSource) { expect_loaded_by({{kCount}}); }

TEST_F(LoadingKernels, OthersAreLeftForLater) {
  write_source("never compiled, process " + std::to_string(getpid()));
  DeviceContext context("", path("kernels"));
  KernelLoader loader(context);
  loader.start({{"no_such_kernel", "", {}}, kCount});
  loader.wait();
  fs::remove(source());
  EXPECT_THROW(context.largest_group(kCount), Error);
}

TEST_F(LoadingKernels, ASecondListIsLoadedAfterAFirst) {
  expect_loaded_by({std::vector<KernelName>(1000, {"no_such_kernel", "", {}}), {kCount}});
}

}  // namespace
}  // namespace dapple
