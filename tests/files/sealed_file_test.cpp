// Sealed files: reading returns the sections that were written. A file with a flipped bit, or of
// another length, kind or version, is refused with a message that names it.
#include "files/sealed_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <random>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

namespace fs = std::filesystem;

constexpr SealedKind kKind{"test", 7};

class SealedFileOnDisk : public FilmFile {
 protected:
  [[nodiscard]] std::string write_small() const {
    const std::array<std::uint32_t, 3> numbers = {1, 2, 3};
    const std::string text = "leaf";
    write_sealed_file(path("a.bin"), kKind, {as_section(numbers), as_section(text)});
    return bytes_of(path("a.bin"));
  }

  std::string refusal_of(const SealedKind& kind = kKind) const {
    const Error error = error_of([&] { open_sealed_file(path("a.bin"), kind); });
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_TRUE(contains(error.what(), path("a.bin") + ": ")) << error.what();
    return error.what();
  }
};

TEST_F(SealedFileOnDisk, SectionsComeBackAlignedWhateverTheirSizes) {
  std::vector<std::vector<std::uint8_t>> written;
  for (const std::size_t size : {0, 1, 127, 128, 129, 0, 3'000'000}) {
    written.emplace_back(size);
    for (std::size_t i = 0; i < size; ++i) written.back()[i] = static_cast<std::uint8_t>(i * i);
  }
  std::vector<Section> sections;
  for (const auto& bytes : written) sections.push_back(as_section(bytes));
  write_sealed_file(path("a.bin"), kKind, sections);
  const SealedFile file = open_sealed_file(path("a.bin"), kKind);
  ASSERT_EQ(file.section_count(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    const auto read = file.values<std::uint8_t>(i);
    EXPECT_TRUE(std::equal(read.begin(), read.end(), written[i].begin(), written[i].end())) << i;
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(read.data()) % kSectionAlignment, 0u);
  }
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(SealedFileOnDisk, AFileWithoutSectionsIsAFile) {
  write_sealed_file(path("a.bin"), kKind, std::initializer_list<Section>{});
  EXPECT_EQ(open_sealed_file(path("a.bin"), kKind).section_count(), 0u);
}

TEST_F(SealedFileOnDisk, TooManySectionsAreRefusedBeforeAnythingIsWritten) {
  const std::vector<Section> sections(kMaxSections + 1);
  try {
    write_sealed_file(path("a.bin"), kKind, sections);
    FAIL() << "written";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("1025 sections"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(path("a.bin")));
  write_sealed_file(path("a.bin"), kKind, std::span(sections).first(kMaxSections));
  EXPECT_EQ(open_sealed_file(path("a.bin"), kKind).section_count(), kMaxSections);
}

TEST_F(SealedFileOnDisk, AnyFlippedBitIsRefusedByName) {
  const std::size_t bits = 8 * write_small().size();
  for (std::size_t bit = 0; bit < bits; ++bit) {
    SCOPED_TRACE(bit);
    flip_bit(path("a.bin"), bit);
    refusal_of();
    flip_bit(path("a.bin"), bit);
  }
  EXPECT_NO_THROW(open_sealed_file(path("a.bin"), kKind));
}

TEST_F(SealedFileOnDisk, AnyOtherLengthIsRefusedByName) {
  const std::string bytes = write_small();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    write_bytes(path("a.bin"), bytes.substr(0, length));
    SCOPED_TRACE(length);
    refusal_of();
  }
  write_bytes(path("a.bin"), bytes + '\0');
  EXPECT_TRUE(contains(refusal_of(), "damaged: it has "));
  write_bytes(path("a.bin"), bytes + bytes);
  refusal_of();
}

TEST_F(SealedFileOnDisk, AnotherKindAndVersionAreToldApart) {
  const std::string bytes = write_small();
  EXPECT_TRUE(contains(refusal_of({"other", 7}), "no other file of dapple"))
      << refusal_of({"other", 7});
  EXPECT_TRUE(contains(refusal_of({"test", 8}),
                       "test file of version 7, this program reads "
                       "version 8"));
  write_bytes(path("a.bin"), "a text");
  EXPECT_TRUE(contains(refusal_of(), "no test file"));
  write_bytes(path("a.bin"), "");
  EXPECT_TRUE(contains(refusal_of(), "it is empty"));
}

TEST_F(SealedFileOnDisk, PathsThatAreNotRegularFilesAreRefusedWithoutBlocking) {
  EXPECT_TRUE(contains(refusal_of(), "No such file"));
  ASSERT_EQ(mkfifo(path("a.bin").c_str(), 0600), 0);
  EXPECT_TRUE(contains(refusal_of(), "not a regular file"));
  fs::remove(path("a.bin"));
  fs::create_directory(path("a.bin"));
  EXPECT_TRUE(contains(refusal_of(), "not a regular file"));
}

TEST_F(SealedFileOnDisk, MissingAndMisshapenSectionsAreRefused) {
  (void)write_small();
  const SealedFile file = open_sealed_file(path("a.bin"), kKind);
  EXPECT_EQ(file.values<std::uint32_t>(0)[2], 3u);
  EXPECT_EQ(error_of([&] { (void)file.values<std::uint64_t>(0); }).kind(), ErrorKind::input);
  EXPECT_EQ(error_of([&] { (void)file.section(2); }).kind(), ErrorKind::input);
}

TEST_F(SealedFileOnDisk, AnOpenFileOutlivesItsReplacementAndRemoval) {
  (void)write_small();
  const SealedFile file = open_sealed_file(path("a.bin"), kKind);
  const std::array<std::uint32_t, 3> others = {7, 8, 9};
  write_sealed_file(path("a.bin"), kKind, {as_section(others)});
  EXPECT_EQ(file.values<std::uint32_t>(0)[0], 1u);
  fs::remove(path("a.bin"));
  EXPECT_EQ(file.values<std::uint32_t>(0)[0], 1u);
}

/// Writes the file again and again until the process is killed. All values of one version of the
/// file are the same number.
[[noreturn]] void write_forever(const std::string& path) {
  for (std::uint32_t number = 0;; ++number) {
    const std::vector<std::uint32_t> numbers(500'000, number);
    write_sealed_file(path, kKind, {as_section(numbers)}, Durable::no);
  }
}

TEST(KilledWriter, LeavesTheOldFileOrTheNewAndTheNextRunCleansUp) {
  const fs::path folder =
      fs::temp_directory_path() / ("dapple_killed_writer_" + std::to_string(getpid()));
  fs::create_directory(folder);
  const std::string path = (folder / "a.bin").string();
  const std::vector<std::uint32_t> first(10, 42);
  write_sealed_file(path, kKind, {as_section(first)});
  std::mt19937 random(1);
  int left_behind = 0;  // temporary files of processes killed while they wrote
  for (int round = 0; round < 2000 && left_behind < 40; ++round) {
    const pid_t child = fork();
    if (child == 0) write_forever(path);
    usleep(static_cast<useconds_t>(random() % 20000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const SealedFile file = open_sealed_file(path, kKind);
    const auto numbers = file.values<std::uint32_t>(0);
    EXPECT_EQ(std::count(numbers.begin(), numbers.end(), numbers[0]),
              static_cast<std::ptrdiff_t>(numbers.size()));
    left_behind += std::distance(fs::directory_iterator(folder), fs::directory_iterator()) > 1;
    remove_abandoned_beside(path);
    ASSERT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
  }
  EXPECT_EQ(left_behind, 40);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace dapple
