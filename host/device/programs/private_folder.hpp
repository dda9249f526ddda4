// A folder that one process alone uses and that goes with it. What processes that were killed
// left behind is removed by the next one that makes a folder in the same place.
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace dapple {

class PrivateFolder {
 public:
  /// Makes `parent`, where it is missing, and a folder in it. Throws Error failed with the reason
  /// alone, "Read-only file system".
  explicit PrivateFolder(const std::filesystem::path& parent);
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;  ///< descriptor of the folder, locked while the process lives
  pid_t owner_;    ///< a fork's child leaves the folder to its parent
};

}  // namespace dapple
