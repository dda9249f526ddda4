// Output files. A file appears complete or not at all, and a failed write leaves nothing behind.
// Overwriting keeps links and permissions; paths that cannot be written are refused beforehand.
#include "files/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <functional>
#include <thread>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

namespace fs = std::filesystem;

class OutputFile : public FilmFile {};

TEST_F(OutputFile, OverwritingLeavesOneFileWithTheOldPermissions) {
  write_bytes(path("a.exr"), "old");
  ASSERT_EQ(chmod(path("a.exr").c_str(), 0640), 0);
  write_exr(ramp_film(2, 2), path("a.exr"));
  EXPECT_EQ(read_exr(path("a.exr")).width, 2);
  EXPECT_EQ(files_in_folder(), 1U);
  EXPECT_EQ(fs::status(path("a.exr")).permissions(), static_cast<fs::perms>(0640));
}

TEST_F(OutputFile, OverwritingKeepsTheGroupAndItsBit) {
  write_bytes(path("a.exr"), "old");
  ASSERT_EQ(chmod(path("a.exr").c_str(), 02660), 0);
  const gid_t other = 54321;
  const bool may_give_away = chown(path("a.exr").c_str(), static_cast<uid_t>(-1), other) == 0;
  ASSERT_EQ(chmod(path("a.exr").c_str(), 02660), 0);
  write_exr(ramp_film(2, 2), path("a.exr"));
  struct stat kept {};
  ASSERT_EQ(stat(path("a.exr").c_str(), &kept), 0);
  EXPECT_EQ(kept.st_mode & 07777, 02660u);
  if (may_give_away) {
    EXPECT_EQ(kept.st_gid, other);
  }
}

TEST_F(OutputFile, WritingThroughALinkKeepsTheLink) {
  write_bytes(path("real.exr"), "old");
  fs::create_symlink("real.exr", path("link.exr"));
  write_exr(ramp_film(2, 2), path("link.exr"));
  EXPECT_TRUE(fs::is_symlink(path("link.exr")));
  EXPECT_EQ(read_exr(path("real.exr")).width, 2);
}

TEST_F(OutputFile, TheLongestPossibleNameCanBeWritten) {
  const std::string name = path(std::string(251, 'a') + ".exr");
  write_exr(ramp_film(2, 2), name);
  EXPECT_EQ(read_exr(name).width, 2);
}

// While an object of this class exists, files cannot grow past `bytes`, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

// A film larger than any buffer. Its pixels are noise, which ZIP cannot shrink below the limits of
// the test.
Film noise_film() {
  Film film = ramp_film(512, 512);
  std::uint32_t state = 1;
  for (Plane& plane : film.planes) {
    for (float& pixel : plane.pixels) {
      state = state * 1664525U + 1013904223U;
      pixel = static_cast<float>(state);
    }
  }
  return film;
}

TEST_F(OutputFile, AFailedWriteNamesTheReasonAndLeavesTheOldFileAlone) {
  const Film film = noise_film();
  for (const rlim_t limit : {rlim_t{0}, rlim_t{100}, rlim_t{1100000}}) {
    write_bytes(path("a.exr"), "old");
    const Error error = [&] {
      const FileSizeLimit full(limit);
      return error_of([&] { write_exr(film, path("a.exr")); });
    }();
    EXPECT_EQ(error.kind(), ErrorKind::failed);
    EXPECT_EQ(error.what(), "cannot write " + path("a.exr") + ": File too large");
    EXPECT_EQ(bytes_of(path("a.exr")), "old");
    EXPECT_EQ(files_in_folder(), 1U);
  }
}

// As processes do: locks are of open files, and temporary names random.
TEST_F(OutputFile, WritersOfOneFileAtOnceLeaveTheWholeFileOfOneOfThem) {
  constexpr std::size_t kBytes = 300'000;
  constexpr int kWriters = 4, kTimes = 40;
  std::atomic<int> writing{kWriters};
  std::vector<std::string> failures(kWriters);
  std::vector<std::thread> writers;
  for (int i = 0; i < kWriters; ++i) {
    writers.emplace_back([&, i] {
      const std::string bytes(kBytes, static_cast<char>('a' + i));
      try {
        for (int time = 0; time < kTimes; ++time) {
          remove_abandoned_beside(path("a.bin"));
          write_whole_file(path("a.bin"), bytes);
        }
      } catch (const Error& error) {
        failures[static_cast<std::size_t>(i)] = error.what();
      }
      --writing;
    });
  }
  // A reader at any time finds one writer's bytes only.
  while (writing > 0) {
    const std::string bytes = bytes_of(path("a.bin"));
    if (bytes.empty()) continue;  // not there yet
    EXPECT_EQ(bytes.size(), kBytes);
    EXPECT_EQ(bytes.find_first_not_of(bytes[0]), std::string::npos);
  }
  for (std::thread& writer : writers) writer.join();
  for (const std::string& failure : failures) EXPECT_EQ(failure, "");
  EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(OutputFile, AnUncommittedFileVanishes) {
  {
    PendingFile file(path("a.bin"));
    file.write("abc", 3);
    file.close();
    EXPECT_EQ(bytes_of(file.temporary_path()), "abc");
  }
  EXPECT_EQ(files_in_folder(), 0U);
}

TEST_F(OutputFile, PendingFileWritesAtThePositionOfASeek) {
  PendingFile file(path("a.bin"));
  file.write("abcdef", 6);
  file.seek(1);
  file.write("XY", 2);
  EXPECT_EQ(file.position(), 3U);
  file.close();
  file.commit();
  EXPECT_EQ(bytes_of(path("a.bin")), "aXYdef");
}

TEST_F(OutputFile, FilesThatHoldWhatWasWrittenPassAlsoAfterASeek) {
  const std::string bytes(2'500'000, 'x');  // two buffers and a half
  PendingFile file(path("a.bin"));
  file.write(bytes.data(), bytes.size());
  file.seek((1U << 20U) - 2);  // over the end of the first buffer
  file.write("abcd", 4);
  file.seek(bytes.size() - 1);  // over the end of the file
  file.write("yz", 2);
  file.close();
  file.verify();
  file.commit();
  std::string expected = bytes;
  expected.replace((1U << 20U) - 2, 4, "abcd").replace(bytes.size() - 1, 1, "yz");
  EXPECT_TRUE(bytes_of(path("a.bin")) == expected);
}

TEST_F(OutputFile, ChangedShortenedAndExtendedFilesDiffer) {
  const auto damage =
      [&](const std::function<void(std::fstream&, const std::string&)>& change) -> std::string {
    PendingFile file(path("a.bin"));
    file.write(std::string(1'500'000, 'x').data(), 1'500'000);
    file.seek(7);
    file.write("seven", 5);
    file.close();
    std::fstream bytes(file.temporary_path(), std::ios::in | std::ios::out | std::ios::binary);
    change(bytes, file.temporary_path());
    bytes.close();
    return error_of([&] { file.verify(); }).what();
  };
  const auto write_at = [](std::streamoff position, char value) {
    return [=](std::fstream& bytes, const std::string&) { bytes.seekp(position).put(value); };
  };
  const std::string differs = "what was read back differs";
  EXPECT_TRUE(contains(damage(write_at(0, 'y')), differs));
  EXPECT_TRUE(contains(damage(write_at(9, 'y')), differs)) << "within what a seek replaced";
  EXPECT_TRUE(contains(damage(write_at(1'499'999, 'y')), differs));
  EXPECT_TRUE(contains(damage(write_at(1'500'000, 'x')), differs));
  EXPECT_TRUE(
      contains(damage([](std::fstream&, const std::string& of) { fs::resize_file(of, 1'499'999); }),
               differs));
  EXPECT_EQ(files_in_folder(), 0U);
}

TEST_F(OutputFile, DamageUnderWhatASeekReplacesIsNotMadeGood) {
  PendingFile file(path("a.bin"));
  file.write("abcdef", 6);
  file.seek(0);
  std::fstream(file.temporary_path(), std::ios::in | std::ios::out).seekp(5).put('x');
  file.write("AB", 2);
  EXPECT_TRUE(contains(error_of([&] { file.close(); }).what(), "what was read back differs"));
}

TEST_F(OutputFile, WholeFilesHoldWhatWasGiven) {
  std::string bytes(3'000'000, '\0');  // about three buffers
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i >> 8U);
  write_whole_file(path("a.bin"), bytes);
  EXPECT_TRUE(bytes_of(path("a.bin")) == bytes);
  write_whole_file(path("a.bin"), "");
  EXPECT_EQ(bytes_of(path("a.bin")), "");
}

TEST_F(OutputFile, OfFilesThatBelongTogetherNoneAppearsBeforeAllAreWritten) {
  write_bytes(path("a"), "old");
  {
    PendingFiles files;
    files.add(path("a"), "new");
    EXPECT_THROW(files.add(path("missing/b"), "new"), Error);
  }
  EXPECT_EQ(bytes_of(path("a")), "old");
  EXPECT_EQ(files_in_folder(), 1u);
  PendingFiles files;
  for (const char* name : {"a", "b"}) files.add(path(name), name);
  EXPECT_EQ(bytes_of(path("a")), "old");
  files.commit();
  EXPECT_EQ(bytes_of(path("a")) + bytes_of(path("b")), "ab");
  EXPECT_EQ(files_in_folder(), 2u);
}

TEST_F(OutputFile, OutputPathsThatCannotBecomeFilesAreRefused) {
  fs::create_directory(path("folder"));
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  const std::string too_long(256, 'a');
  for (const std::string& bad :
       {path("folder"), path("fifo"), path("missing/a.exr"), path("folder/"), path(too_long),
        std::string(), std::string("/dev/null")}) {
    const Error error = error_of([&] { check_output_path(bad); });
    EXPECT_EQ(error.kind(), ErrorKind::usage) << bad;
    EXPECT_TRUE(contains(error.what(), "cannot write " + bad + ": ")) << error.what();
    EXPECT_EQ(error_of([&] { write_exr(ramp_film(1, 1), bad); }).kind(), ErrorKind::failed) << bad;
  }
  EXPECT_EQ(files_in_folder(), 2U);
}

TEST_F(OutputFile, OutputPathsThatCanBecomeFilesAreAcceptedAndUntouched) {
  write_bytes(path("there.exr"), "old");
  EXPECT_NO_THROW(check_output_path(path("there.exr")));
  EXPECT_NO_THROW(check_output_path(path("new.exr")));
  EXPECT_EQ(bytes_of(path("there.exr")), "old");
  EXPECT_EQ(files_in_folder(), 1U);
}

}  // namespace
}  // namespace dapple
