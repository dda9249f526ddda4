// Lights files in a temporary folder. In: JSON text; out: the lights, or the Error's message.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"

namespace dapple::lights_test {

// A temporary file that the destructor removes.
class LightsFile {
 public:
  explicit LightsFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("dapple_lights_" + std::to_string(getpid()) + "_" + std::to_string(next_++) +
               ".json")) {
    std::ofstream(path_) << text;
  }
  ~LightsFile() { std::filesystem::remove(path_); }
  LightsFile(const LightsFile&) = delete;
  LightsFile& operator=(const LightsFile&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  static inline int next_ = 0;
  std::filesystem::path path_;
};

inline std::vector<Light> load(const std::string& text) {
  return load_lights(LightsFile(text).path());
}

inline std::vector<Light> load_one(const std::string& fields) {
  return load("{\"lights\": [{" + fields + "}]}");
}

// The message of the Error, without the file's name. The message must begin with that name.
inline std::string complaint_about_path(const std::string& path) {
  try {
    load_lights(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    const std::string message = error.what();
    EXPECT_EQ(message.find(path + ": "), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message.substr(path.size() + 2);
  }
  return "no error";
}

inline std::string complaint(const std::string& text) {
  const LightsFile file(text);
  return complaint_about_path(file.path());
}

inline std::string complaint_about(const std::string& fields) {
  return complaint("{\"lights\": [{" + fields + "}]}");
}

}  // namespace dapple::lights_test
