// A lock shows whether the process that made a file still runs. The process id in the file's name
// could not: ids are used again, and mean nothing in another container. A process locks an
// abandoned file before it removes it; a maker that gets its lock only afterwards finds its new
// file removed, and tries another name.
#include "files/temporary_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <filesystem>
#include <functional>
#include <random>
#include <string_view>

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr int kNameAttempts = 100;
constexpr std::string_view kPrefix = ".dapple-", kSuffix = ".tmp";

/// Owns a file descriptor, or -1, and closes it.
class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  ~Descriptor() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  int descriptor_;
};

/// ".dapple-HOST-PROCESS-RANDOM.tmp". It does not contain the target's name, which may already have
/// the maximum length.
std::string random_name() {
  static thread_local std::random_device random;
  return fmt::format("{}{}-{}-{:08x}{:08x}{}", kPrefix, host_code(), getpid(), random(), random(),
                     kSuffix);
}

bool is_our_name(std::string_view name) {
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return false;
  name.remove_prefix(kPrefix.size());
  name.remove_suffix(kSuffix.size());
  return name.find_first_not_of("0123456789abcdef-") == std::string_view::npos &&
         std::count(name.begin(), name.end(), '-') == 2;
}

/// Locks the file. False when another process removed it before it was locked; true on file systems
/// without locks.
bool lock_new_file(int descriptor) {
  while (flock(descriptor, LOCK_EX) != 0 && errno == EINTR) {
  }
  struct stat status {};
  return fstat(descriptor, &status) == 0 && status.st_nlink > 0;
}

/// Removes the file if the process that made it has ended; returns whether it did. Files of other
/// hosts must also be unchanged for a day.
bool remove_if_abandoned(const fs::path& path, bool own_host) {
  const Descriptor file(open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (file.get() < 0 || fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
  if (flock(file.get(), LOCK_EX | LOCK_NB) != 0) return false;
  if (!own_host && status.st_mtime > std::time(nullptr) - kAbandonedSeconds) return false;
  return unlink(path.c_str()) == 0;
}

}  // namespace

std::string host_code() {
  char name[256] = {};
  if (gethostname(name, sizeof name - 1) != 0) name[0] = '\0';
  return fmt::format("{:08x}", static_cast<std::uint32_t>(std::hash<std::string>{}(name)));
}

TemporaryFile create_temporary_file(const std::string& folder) {
  TemporaryFile file;
  for (int attempt = 0; attempt < kNameAttempts; ++attempt) {
    file.path = (fs::path(folder) / random_name()).string();
    // O_EXCL: an existing file of that name, or a link that somebody planted in /tmp, is not used.
    file.descriptor = open(file.path.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (file.descriptor < 0 && errno != EEXIST) break;
    if (file.descriptor < 0) continue;
    if (lock_new_file(file.descriptor)) return file;
    close(file.descriptor);
    file.descriptor = -1;
  }
  return file;
}

std::size_t remove_abandoned_files(const std::string& folder) {
  const std::string own = std::string(kPrefix) + host_code() + '-';
  std::size_t removed = 0;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (is_our_name(name) && remove_if_abandoned(at->path(), name.starts_with(own))) ++removed;
  }
  return removed;
}

}  // namespace dapple
