// Shared by the tests of films and their files: a temporary folder for each test, small films,
// reading and damaging files byte by byte, and a function that returns a thrown Error as a value.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "dapple/error.hpp"
#include "dapple/film.hpp"

namespace dapple::film_test {

// A test with its own folder, which is removed after the test.
class FilmFile : public ::testing::Test {
 protected:
  FilmFile() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("dapple_film_" + std::to_string(getpid()) + "_" + test->name());
    std::filesystem::create_directory(folder_);
  }
  ~FilmFile() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  /// `bytes`: a string or a vector of bytes.
  template <typename Bytes>
  void write(const std::string& name, const Bytes& bytes) const {
    std::ofstream(path(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  [[nodiscard]] std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_),
                                                  std::filesystem::directory_iterator()));
  }

  std::filesystem::path folder_;
};

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  const auto folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  std::ofstream(path, std::ios::binary) << bytes;
}

// Flips one bit of the file and writes no other byte.
inline void flip_bit(const std::string& path, std::size_t bit) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekg(static_cast<std::streamoff>(bit / 8));
  const int byte = file.get();
  file.seekp(static_cast<std::streamoff>(bit / 8));
  file.put(static_cast<char>(byte ^ (1 << bit % 8)));
}

inline std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

// Returns the Error that `action` throws; fails the test when it throws none.
inline Error error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no Error was thrown";
  return {ErrorKind::failed, ""};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// Two channels; each value depends on row, column and channel.
inline Film ramp_film(int width, int height) {
  Film film;
  film.width = width;
  film.height = height;
  film.data_window = {0, 0, width - 1, height - 1};
  film.planes = {{"Z", {}}, {"ao.R", {}}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      film.planes[0].pixels.push_back(static_cast<float>(1000 * y + x));
      film.planes[1].pixels.push_back(-static_cast<float>(1000 * y + x) / 7.0f);
    }
  }
  return film;
}

inline FilmMetadata some_metadata() {
  FilmMetadata metadata;
  metadata.world_to_camera = M44f(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
  metadata.world_to_ndc = M44f(16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1);
  metadata.samples = 64;
  metadata.seed = 4'000'000'000U;  // larger than a signed 32-bit attribute can hold
  metadata.scene = "scene:tree?leaves=50000";
  metadata.device = "pthread-model";
  metadata.version = "0.1.0";
  metadata.settings = {{"ao-distance", "0"}, {"footprint", "1.5"}};
  return metadata;
}

}  // namespace dapple::film_test
