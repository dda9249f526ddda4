// A folder that only one process uses, and that is removed when the process ends. If a process is
// killed, its folder remains until the next PrivateFolder in the same parent folder removes it.
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace dapple {

class PrivateFolder {
 public:
  /// Makes `parent` if it is missing, and a folder in it. Throws Error failed, whose message is
  /// only the reason, "Read-only file system".
  explicit PrivateFolder(const std::filesystem::path& parent);
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;  ///< descriptor of the folder, locked as long as it is open
  pid_t owner_;    ///< forked child processes do not remove the folder
};

}  // namespace dapple
