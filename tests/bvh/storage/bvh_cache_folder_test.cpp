// The folder of the BVH cache: it is made if it is missing, and one that cannot be used is an error
// that names the option.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dapple/bvh.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

namespace fs = std::filesystem;

class BvhCacheFolder : public FilmFile {};

TEST_F(BvhCacheFolder, WhatCannotBeAFolderIsAUsageErrorThatNamesTheOption) {
  write_bytes(path("file"), "x");
  const Scene scene = make_procedural("scene:cube?divisions=1");
  for (const std::string& bad : {path("file"), path("file/below"), std::string("/proc/none")}) {
    const Error error = error_of([&] { build_bvh(scene, bad); });
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_TRUE(contains(error.what(), "--cache " + bad + ": ")) << error.what();
  }
  EXPECT_EQ(bytes_of(path("file")), "x");
}

constexpr const char* kNoUser = "root is the only user";

/// The message with which prepare_bvh_cache() refuses the folder, in a process that is not root's:
/// root may write everywhere. Empty: another error or none; kNoUser: there can be no such process.
std::string refusal_by_permissions(const std::string& folder) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    std::string text;
    try {
      if (geteuid() == 0 && setresuid(kNobody, kNobody, kNobody) != 0)
        text = kNoUser;
      else
        prepare_bvh_cache(folder);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::usage) text = error.what();
    }
    static_cast<void>(!write(ends[1], text.data(), text.size()));
    _exit(0);
  }
  close(ends[1]);
  char text[4096];
  const ssize_t length = read(ends[0], text, sizeof text);  // less than a pipe holds, in one piece
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return {text, static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

TEST_F(BvhCacheFolder, AReadOnlyOneIsAUsageError) {
  const std::string cache = path("cache");
  fs::create_directory(cache);
  constexpr fs::perms kReadOnly = static_cast<fs::perms>(0555);
  fs::permissions(cache, kReadOnly);
  const std::string message = refusal_by_permissions(cache);
  fs::permissions(cache, fs::perms::owner_all);
  if (message == kNoUser) GTEST_SKIP() << message;
  EXPECT_TRUE(message.starts_with("--cache " + cache + ": ")) << message;
  EXPECT_TRUE(contains(message, "Permission denied")) << message;
}

TEST_F(BvhCacheFolder, AMissingOneIsMadeWithThoseAboveIt) {
  prepare_bvh_cache(path("a/b/c"));
  EXPECT_TRUE(fs::is_directory(path("a/b/c")));
}

}  // namespace
}  // namespace dapple
