// Temporary files: remove_abandoned_files() removes those of processes that have ended. It keeps
// those of running processes, and all files with other names.
#include "files/temporary_file.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "files/output_file.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

class TemporaryFiles : public FilmFile {};

/// Creates a temporary file in a process that is then killed. Returns the file's path.
std::string abandoned_file(const std::string& folder) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    const TemporaryFile file = create_temporary_file(folder);
    (void)!write(ends[1], file.path.data(), file.path.size());
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  close(ends[1]);
  char path[4096];
  const ssize_t length = read(ends[0], path, sizeof path);
  close(ends[0]);
  return {path, static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

TEST_F(TemporaryFiles, FilesOfRunningProcessesAreKeptAndOthersRemoved) {
  const TemporaryFile living = create_temporary_file(folder_);
  ASSERT_GE(living.descriptor, 0);
  const std::string dead = abandoned_file(folder_);
  EXPECT_TRUE(std::filesystem::exists(dead)) << dead;
  EXPECT_EQ(remove_abandoned_files(folder_), 1u);
  EXPECT_FALSE(std::filesystem::exists(dead));
  EXPECT_TRUE(std::filesystem::exists(living.path));
  close(living.descriptor);
  EXPECT_EQ(remove_abandoned_files(folder_), 1u);
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(TemporaryFiles, AnUncommittedFileIsLockedUntilItHasItsName) {
  PendingFile file(path("a.bin"));
  file.write("abc", 3);
  file.close();
  EXPECT_EQ(remove_abandoned_files(folder_), 0u);
  file.commit();
  EXPECT_EQ(bytes_of(path("a.bin")), "abc");
}

TEST_F(TemporaryFiles, ThoseOfOtherHostsStayForADay) {
  const std::string dead = abandoned_file(folder_);
  std::string other = dead;
  const std::size_t host = other.rfind(".dapple-") + 8;
  other[host] = other[host] == '0' ? '1' : '0';
  std::filesystem::rename(dead, other);
  EXPECT_EQ(remove_abandoned_files(folder_), 0u);
  std::filesystem::last_write_time(
      other, std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
  EXPECT_EQ(remove_abandoned_files(folder_), 1u);
}

TEST_F(TemporaryFiles, FilesWithOtherNamesAreKept) {
  for (const char* name : {".dapple-1-2.tmp", ".dapple-.tmp", "a.exr", "dapple-0-1-2.tmp",
                           ".dapple-0000000g-1-0000000000000000.tmp", ".dapple-0-1-2.tmpx"}) {
    write_bytes(path(name), "x");
  }
  const std::string dead = abandoned_file(folder_);
  const std::string target = path("precious");
  write_bytes(target, "x");
  std::filesystem::remove(dead);
  std::filesystem::create_symlink("precious", dead);
  EXPECT_EQ(remove_abandoned_files(folder_), 0u);
  EXPECT_EQ(files_in_folder(), 8u);
  EXPECT_EQ(remove_abandoned_files(path("missing")), 0u);
}

TEST_F(TemporaryFiles, NamesDifferAndAMissingFolderIsAnError) {
  const TemporaryFile a = create_temporary_file(folder_), b = create_temporary_file(folder_);
  EXPECT_NE(a.path, b.path);
  close(a.descriptor);
  close(b.descriptor);
  EXPECT_EQ(create_temporary_file(path("missing")).descriptor, -1);
}

}  // namespace
}  // namespace dapple
