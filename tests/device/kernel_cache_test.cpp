// The cache of compiled kernels: the next run and other processes use what one run compiled.
// Damaged or incomplete files are never used, but compiled again.
#include "device/programs/kernel_cache.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <thread>

#include "device/environment_while.hpp"
#include "device/programs/sealed_folder.hpp"
#include "files/temporary_file.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;

namespace fs = std::filesystem;

const fs::path kProgram = "AB/PROGRAM";

class KernelCacheFiles : public FilmFile {
 protected:
  /// Does what a process does: compiles `text` as PoCL would, unless the cache has it, and keeps
  /// the files. Returns whether it compiled.
  [[nodiscard]] bool compiles(const std::string& text) const {
    const EnvironmentWhile place("POCL_CACHE_DIR", path("cache"));
    KernelCache cache;
    bool compiled = false;
    cache.build(text, [&] {
      const fs::path program = cache.folder() / kProgram;
      if (fs::exists(program / "program.bc")) return;
      compiled = true;
      fs::create_directories(program / "kernel/64-1-1");
      write_bytes(program / "program.bc", "bitcode of " + text);
    });
    const fs::path machine_code = cache.folder() / kProgram / "kernel/64-1-1/kernel.so";
    if (compiled) write_bytes(machine_code, "code of " + text);
    EXPECT_EQ(bytes_of(machine_code), "code of " + text);
    cache.keep(text);
    return compiled;
  }

  /// Path of a file of this name in the cache; fails if there is none.
  [[nodiscard]] fs::path kept(const std::string& name) const {
    for (const auto& entry : fs::recursive_directory_iterator(path("cache"))) {
      if (entry.path().filename() == name) return entry.path();
    }
    ADD_FAILURE() << name << " is not there";
    return {};
  }

  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path("cache")), {}));
  }
};

TEST_F(KernelCacheFiles, TheNextRunReusesCompiledKernels) {
  EXPECT_TRUE(compiles("one"));
  EXPECT_FALSE(compiles("one"));
  EXPECT_TRUE(compiles("two")) << "another program";
  EXPECT_FALSE(compiles("one"));
  EXPECT_EQ(entries(), 2u) << "one an entry, and no folder of a run";
}

TEST_F(KernelCacheFiles, ADamagedFileIsCompiledAgainAndKeptAgain) {
  const std::function<void(const fs::path&)> damages[] = {
      [](const fs::path& file) { fs::resize_file(file, 3); },
      [](const fs::path& file) { fs::resize_file(file, 0); },
      [](const fs::path& file) { fs::remove(file); },
      [](const fs::path& file) { write_bytes(file, bytes_of(file) + " "); },
      [](const fs::path& file) {
        std::string bytes = bytes_of(file);
        bytes[bytes.size() / 2] ^= 1;
        write_bytes(file, bytes);
      },
      [](const fs::path& file) {
        fs::remove(file);
        fs::create_directory(file);
      },
  };
  for (const char* name : {"program.bc", "kernel.so", "sealed"}) {
    for (std::size_t i = 0; i < std::size(damages); ++i) {
      static_cast<void>(compiles("one"));
      damages[i](kept(name));
      EXPECT_TRUE(compiles("one")) << name << ", damage " << i;
      EXPECT_FALSE(compiles("one")) << name << ", damage " << i;
    }
  }
}

TEST_F(KernelCacheFiles, ADamagedSealNamesNoFileOutsideOfItsFolder) {
  static_cast<void>(compiles("one"));
  const std::string line = "0000000000000000 ../../../outside\n";
  write_bytes(kept("sealed"), line);
  EXPECT_TRUE(compiles("one"));
  EXPECT_FALSE(fs::exists(path("outside")));
}

TEST_F(KernelCacheFiles, FoldersOfKilledProcessesAreRemovedAndThoseOfRunningOnesKept) {
  const PrivateFolder living(path("cache"));
  const fs::path dead = path("cache/dapple-run-" + host_code() + "-killed");
  fs::create_directories(dead / "pocl");
  EXPECT_TRUE(compiles("one"));
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(living.path()));
}

// On a network file system, locks of folders are only seen by processes of the same host.
TEST_F(KernelCacheFiles, FoldersOfOtherHostsAreKeptForADay) {
  const fs::path running = path("cache/dapple-run-0-running"), old = path("cache/dapple-run-0-old");
  for (const fs::path& folder : {running, old}) fs::create_directories(folder / "pocl");
  fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(25));
  EXPECT_TRUE(compiles("one"));
  EXPECT_TRUE(fs::exists(running / "pocl"));
  EXPECT_FALSE(fs::exists(old));
}

TEST_F(KernelCacheFiles, FoldersOfManyThreadsNeverCollide) {
  std::vector<std::thread> threads;
  std::atomic<int> lost = 0;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        const PrivateFolder mine(path("cache"));
        write_bytes(mine.path() / "mine", "x");
        if (bytes_of(mine.path() / "mine") != "x") ++lost;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(entries(), 0u);
}

TEST_F(KernelCacheFiles, TheLeastRecentlyUsedProgramsAreRemoved) {
  const auto name = [](int i) { return "program " + std::to_string(i); };
  constexpr int kLimit = 96;
  for (int i = 0; i < kLimit; ++i) EXPECT_TRUE(compiles(name(i)));
  // As if they had been compiled in this order, a second after each other, two hours ago.
  const auto then = fs::file_time_type::clock::now() - std::chrono::hours(2);
  for (const auto& entry : fs::directory_iterator(path("cache"))) {
    const std::string text = bytes_of(entry.path() / kProgram / "program.bc");
    const int number = std::stoi(text.substr(text.rfind(' ')));
    fs::last_write_time(entry, then + std::chrono::seconds(number));
  }
  EXPECT_FALSE(compiles(name(0))) << "the oldest is used";
  for (int i = kLimit; i < kLimit + 4; ++i) EXPECT_TRUE(compiles(name(i)));
  EXPECT_EQ(entries(), std::size_t{kLimit});
  const EnvironmentWhile place("POCL_CACHE_DIR", path("cache"));
  const KernelCache cache;
  for (int i = 0; i < kLimit + 4; ++i)
    EXPECT_EQ(cache.has(name(i), ""), i == 0 || i > 4) << name(i);
}

class KernelCacheCold : public program_test::ProgramRun {
 protected:
  [[nodiscard]] program_test::Outcome render_with_cache(const std::string& before = "") const {
    return render("-q", before + " POCL_CACHE_DIR='" + path("cache") + "'");
  }
  void damage_all(const std::string& name, std::uintmax_t bytes) const {
    int damaged = 0;
    for (const auto& entry : fs::recursive_directory_iterator(path("cache"))) {
      if (!entry.path().native().ends_with(name)) continue;
      fs::resize_file(entry.path(), bytes);
      ++damaged;
    }
    EXPECT_GE(damaged, 3) << "camera rays, packets, the rest";
  }
};

TEST_F(KernelCacheCold, TruncatedKernelsAreCompiledAgainToTheSamePicture) {
  ASSERT_EQ(render_with_cache().code, 0);
  const std::string picture = bytes_of(path("out.exr"));
  const std::pair<const char*, std::uintmax_t> damages[] = {
      {".so", 100}, {"program.bc", 1000}, {"program.bc", 0}};
  for (const auto& [name, bytes] : damages) {
    damage_all(name, bytes);
    const auto run = render_with_cache();
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    EXPECT_TRUE(bytes_of(path("out.exr")) == picture) << name;
  }
}

TEST_F(KernelCacheCold, EightProcessesWithOneColdCacheMakeTheSamePicture) {
  std::array<int, 8> codes{};
  std::vector<std::thread> processes;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    processes.emplace_back([&, i] {
      const std::string command =
          "POCL_CACHE_DIR='" + path("cache") +
          "' " DAPPLE_PROGRAM
          " render 'scene:tree?leaves=200' --width 32 --height 32 --spp 2 -q -o '" +
          path(std::to_string(i) + ".exr") + "'";
      codes[i] = std::system(command.c_str());
    });
  }
  for (std::thread& process : processes) process.join();
  for (std::size_t i = 0; i < codes.size(); ++i) {
    EXPECT_EQ(codes[i], 0);
    EXPECT_TRUE(bytes_of(path(std::to_string(i) + ".exr")) == bytes_of(path("0.exr"))) << i;
  }
  EXPECT_FALSE(bytes_of(path("0.exr")).empty());
}

}  // namespace
}  // namespace dapple
