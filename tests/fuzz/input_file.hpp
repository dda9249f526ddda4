// A temporary file for readers that take a path. In: the fuzzer's bytes of each run; out: the path
// of the file with these bytes. The destructor removes the file and its folder.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace dapple::fuzz {

class InputFile {
 public:
  explicit InputFile(const std::string& name)
      : folder_(std::filesystem::temp_directory_path() /
                ("dapple_fuzz_" + std::to_string(::getpid()))),
        path_((folder_ / name).string()) {
    std::filesystem::create_directory(folder_);
  }
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& fill(const std::uint8_t* bytes, std::size_t count) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    return path_;
  }

 private:
  std::filesystem::path folder_;
  std::string path_;
};

}  // namespace dapple::fuzz
