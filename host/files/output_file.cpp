// Writes with POSIX calls, because iostreams lose errno, and the user must learn of "No space left
// on device".
#include "files/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "dapple/error.hpp"
#include "files/temporary_file.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr const char* kDiffers = "what was read back differs from what was written";

std::string cannot_write(const std::string& path, const std::string& reason) {
  return "cannot write " + path + ": " + reason;
}

std::string folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

// The path with symbolic links followed. A path that cannot be resolved (a loop, an unreadable
// folder) stays as it is; the checks after this refuse it.
std::string follow_links(const std::string& path) {
  std::error_code ignored;
  const fs::path resolved = fs::canonical(path, ignored);
  return ignored ? path : resolved.string();
}

// Why `target` cannot be written; empty when it can.
std::string refusal(const std::string& target) {
  if (target.empty()) return "the name is empty";
  std::error_code problem;
  const fs::file_status status = fs::status(target, problem);
  // Renaming over it would replace the link, and dapple does not create the file that it names.
  if (!fs::exists(status) && fs::is_symlink(fs::symlink_status(target, problem)))
    return "it is a symbolic link that leads nowhere";
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

// An overwritten file keeps its owner and group, where this process may give files away, and its
// permissions. If that fails, it gets the default ones of the umask. Changing the owner clears the
// setgid bit, so that permissions come last.
void copy_permissions(const std::string& from, int to) {
  struct stat existing {};
  if (stat(from.c_str(), &existing) != 0) return;
  const bool is_owned = fchown(to, existing.st_uid, existing.st_gid) == 0 ||
                        fchown(to, static_cast<uid_t>(-1), existing.st_gid) == 0;
  const mode_t kept = is_owned ? 0777 | S_ISGID : 0777;
  if (fchmod(to, existing.st_mode & kept) != 0) errno = 0;
}

}  // namespace

void check_output_path(const std::string& path) {
  const std::string reason = refusal(follow_links(path));
  if (!reason.empty()) throw Error(ErrorKind::usage, cannot_write(path, reason));
}

void remove_abandoned_beside(const std::string& path) {
  remove_abandoned_files(folder_of(follow_links(path)));
}

void remove_link(const std::string& path) {
  std::error_code ignored;
  if (fs::is_symlink(fs::symlink_status(path, ignored))) fs::remove(path, ignored);
}

PendingFile::PendingFile(const std::string& target) : name_(target), target_(follow_links(target)) {
  const std::string reason = refusal(target_);
  if (!reason.empty()) throw Error(ErrorKind::failed, cannot_write(name_, reason));
  TemporaryFile file = create_temporary_file(folder_of(target_));
  descriptor_ = file.descriptor;
  if (descriptor_ < 0) {
    throw Error(ErrorKind::failed, cannot_write(name_, std::strerror(errno)));
  }
  temporary_ = std::move(file.path);
  lock_ = fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);
  copy_permissions(target_, descriptor_);
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
  if (!written_.add(descriptor_, flushed_, buffer_)) fail(kDiffers);
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

void PendingFile::close(Durable durable) {
  flush();
  // EINVAL and ENOSYS: the file system cannot sync; this is no error.
  if (durable == Durable::yes && fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOSYS)
    fail_with_errno();
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) fail_with_errno();
}

void PendingFile::verify() {
  assert(descriptor_ < 0);
  if (!written_.are_in(temporary_)) fail(kDiffers);
}

void PendingFile::commit() {
  assert(descriptor_ < 0);
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail_with_errno();
  temporary_.clear();
}

void PendingFiles::add(const std::string& path, std::string_view bytes) {
  PendingFile& file = add(path);
  file.write(bytes.data(), bytes.size());
  file.close();
  file.verify();
}

void PendingFiles::commit() {
  for (PendingFile& file : files_) file.commit();
  files_.clear();
}

void write_whole_file(const std::string& path, std::string_view bytes) {
  write_whole_file(path, std::span(&bytes, 1));
}

void write_whole_file(const std::string& path, std::span<const std::string_view> sections) {
  PendingFile file(path);
  for (const std::string_view section : sections) file.write(section.data(), section.size());
  file.close();
  file.verify();
  file.commit();
}

}  // namespace dapple
