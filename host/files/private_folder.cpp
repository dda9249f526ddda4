// A lock shows whether the process that made a folder still runs. The operating system releases it
// however the process ends, and unlike a process id it is valid in all containers that share the
// parent folder. Locks of folders on network file systems are only visible on their own host.
#include "files/private_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <string>

#include "dapple/error.hpp"
#include "files/temporary_file.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "dapple-run-";
constexpr int kAttempts = 20;

int open_folder(const fs::path& folder) {
  return open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
}

bool is_removed(int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) != 0 || status.st_nlink == 0;
}

/// Whether the open folder has not changed for so long that its host no longer uses it.
bool is_old(int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 &&
         status.st_mtime < std::time(nullptr) - kAbandonedSeconds;
}

void remove_stale_folders(const fs::path& parent) {
  const std::string own = kPrefix + host_code() + '-';
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix)) continue;
    const int lock = open_folder(entry.path());
    if (lock < 0) continue;
    if ((name.starts_with(own) || is_old(lock)) && flock(lock, LOCK_EX | LOCK_NB) == 0)
      fs::remove_all(entry.path(), ignored);
    close(lock);
  }
}

}  // namespace

PrivateFolder::PrivateFolder(const fs::path& parent) : owner_(getpid()) {
  std::error_code error;
  fs::create_directories(parent, error);
  if (error) throw Error(ErrorKind::failed, error.message());
  remove_stale_folders(parent);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::string name = (parent / (kPrefix + host_code() + "-XXXXXX")).string();
    if (!mkdtemp(name.data())) throw Error(ErrorKind::failed, std::strerror(errno));
    lock_ = open_folder(name);
    path_ = name;
    // Before it is locked, a new folder looks abandoned, and another process may remove it. On file
    // systems without locks no process removes the folders of others.
    if (lock_ >= 0 && (flock(lock_, LOCK_EX) != 0 || !is_removed(lock_))) return;
    if (lock_ >= 0) close(lock_);
    lock_ = -1;
  }
  throw Error(ErrorKind::failed, "folders vanish as soon as they are made");
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  if (getpid() == owner_) fs::remove_all(path_, ignored);
  if (lock_ >= 0) close(lock_);
}

}  // namespace dapple
