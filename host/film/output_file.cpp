// Pending files on POSIX calls: iostreams lose errno, and "No space left on device" is the
// one thing that the user must be told. In: bytes. Out: a finished file, or an Error.
#include "film/output_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "dapple/error.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr int kNameAttempts = 100;

std::string cannot_write(const std::string& path, const std::string& reason) {
  return "cannot write " + path + ": " + reason;
}

std::string folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

// A path that does not resolve (a loop, an unreadable folder) is left for open() to refuse.
std::string follow_links(const std::string& path) {
  std::error_code ignored;
  const fs::path resolved = fs::canonical(path, ignored);
  return ignored ? path : resolved.string();
}

// Why `target` cannot become a file of ours; empty when it can.
std::string refusal(const std::string& target) {
  if (target.empty()) return "the name is empty";
  std::error_code problem;
  const fs::file_status status = fs::status(target, problem);
  if (fs::is_directory(status)) return "it is a folder";
  if (fs::exists(status) && !fs::is_regular_file(status)) return "it is not a regular file";
  if (fs::exists(status) && access(target.c_str(), W_OK) != 0) return std::strerror(errno);
  if (fs::path(target).filename().empty()) return "it names a folder, not a file";

  const std::string folder = folder_of(target);
  if (!fs::is_directory(folder, problem)) return "there is no folder " + folder;
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    return "folder " + folder + ": " + std::strerror(errno);
  }
  const auto longest = pathconf(folder.c_str(), _PC_NAME_MAX);
  if (longest > 0 && fs::path(target).filename().native().size() > std::size_t(longest)) {
    return std::strerror(ENAMETOOLONG);
  }
  return {};
}

// The name does not contain the target's: that may already be as long as names can be.
std::string next_temporary_name(const std::string& target) {
  static std::atomic<unsigned> counter{0};
  const std::string name =
      ".dapple-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp";
  return (fs::path(folder_of(target)) / name).string();
}

// The kernel lets go of locks however a process ends: who can take one finds a file that nobody
// will finish.
void remove_abandoned(const std::string& folder) {
  std::error_code problem;
  for (fs::directory_iterator entry(folder, problem), end; !problem && entry != end;
       entry.increment(problem)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(".dapple-") || !name.ends_with(".tmp")) continue;
    const int file = open(entry->path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) continue;
    if (flock(file, LOCK_EX | LOCK_NB) == 0) unlink(entry->path().c_str());
    ::close(file);
  }
}

// Locks a new file through a descriptor of its own; -1 where another process took it for abandoned
// before that. A file system without locks has no abandoned files either.
int lock_new_file(int descriptor) {
  const int lock = fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  struct stat status {};
  if (lock < 0 || flock(lock, LOCK_EX) != 0) return lock;
  if (fstat(lock, &status) == 0 && status.st_nlink > 0) return lock;
  ::close(lock);
  return -1;
}

// An overwritten file keeps its permissions. Where that fails, the umask's are no worse.
void copy_permissions(const std::string& from, int to) {
  struct stat existing {};
  if (stat(from.c_str(), &existing) == 0 && fchmod(to, existing.st_mode & 0777) != 0) errno = 0;
}

}  // namespace

void check_output_path(const std::string& path) {
  const std::string reason = refusal(follow_links(path));
  if (!reason.empty()) throw Error(ErrorKind::usage, cannot_write(path, reason));
}

PendingFile::PendingFile(const std::string& target) : name_(target), target_(follow_links(target)) {
  const std::string reason = refusal(target_);
  if (!reason.empty()) throw Error(ErrorKind::failed, cannot_write(name_, reason));
  remove_abandoned(folder_of(target_));
  // O_EXCL: whatever already has that name, a link planted in /tmp included, is not ours.
  for (int attempt = 0; attempt < kNameAttempts && descriptor_ < 0; ++attempt) {
    temporary_ = next_temporary_name(target_);
    descriptor_ = open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
    if (descriptor_ < 0) continue;
    lock_ = lock_new_file(descriptor_);
    if (lock_ >= 0) break;
    ::close(descriptor_);
    descriptor_ = -1;
  }
  if (descriptor_ < 0) {
    throw Error(ErrorKind::failed, cannot_write(name_, std::strerror(errno)));
  }
  copy_permissions(target_, descriptor_);
  buffer_.reserve(kBufferBytes);
}

PendingFile::~PendingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
  if (lock_ >= 0) ::close(lock_);
}

void PendingFile::fail(const std::string& reason) {
  if (first_failure_.empty()) first_failure_ = reason;
  throw Error(ErrorKind::failed, cannot_write(name_, first_failure_));
}

void PendingFile::fail_with_errno() { fail(std::strerror(errno)); }

void PendingFile::write(const char* bytes, std::size_t count) {
  while (count > 0) {
    const std::size_t step = std::min(count, kBufferBytes - buffer_.size());
    buffer_.append(bytes, step);
    bytes += step;
    count -= step;
    if (buffer_.size() == kBufferBytes) flush();
  }
}

void PendingFile::flush() {
  if (!first_failure_.empty()) fail(first_failure_);
  assert(descriptor_ >= 0);
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t step = pwrite(descriptor_, buffer_.data() + done, buffer_.size() - done,
                                static_cast<off_t>(flushed_ + done));
    if (step < 0 && errno == EINTR) continue;
    if (step < 0) fail_with_errno();
    done += static_cast<std::size_t>(step);
  }
  flushed_ += buffer_.size();
  buffer_.clear();
}

void PendingFile::seek(std::uint64_t position) {
  flush();
  flushed_ = position;
}

void PendingFile::close() {
  flush();
  // EINVAL: some file systems cannot sync, which is theirs to decide.
  if (fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOSYS) fail_with_errno();
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) fail_with_errno();
}

void PendingFile::commit() {
  assert(descriptor_ < 0);
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail_with_errno();
  temporary_.clear();
}

void write_whole_file(const std::string& path, std::string_view bytes) {
  PendingFile file(path);
  file.write(bytes.data(), bytes.size());
  file.close();

  std::ifstream reread(file.temporary_path(), std::ios::binary);
  std::vector<char> block(kBufferBytes);
  std::size_t done = 0;
  while (reread.read(block.data(), static_cast<std::streamsize>(block.size())),
         reread.gcount() > 0) {
    const std::string_view got(block.data(), static_cast<std::size_t>(reread.gcount()));
    if (bytes.substr(std::min(done, bytes.size()), got.size()) != got) break;
    done += got.size();
  }
  if (done != bytes.size()) file.fail("what was read back differs from what was written");
  file.commit();
}

}  // namespace dapple
