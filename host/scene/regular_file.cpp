// POSIX calls, which tell a FIFO from a file without waiting for it.
#include "scene/regular_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "scene/message.hpp"

namespace dapple {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

void check_kind(const struct stat& status, const std::string& what) {
  if (S_ISDIR(status.st_mode)) fail(what, "is a folder, not a file");
  if (!S_ISREG(status.st_mode)) fail(what, "is not a regular file");
}

[[noreturn]] void fail_with_errno(const std::string& what, const FileKind& kind) {
  if (errno == ENOENT) fail(what, "no such {}", kind.name);
  fail(what, "cannot be read ({})", std::strerror(errno));
}

/// The file's kind is checked before opening, because opening a device may have an effect.
/// regular_size() checks it again after opening, because another program may have replaced the file
/// in between, even by a FIFO; O_NONBLOCK prevents waiting for that.
int open_regular(const std::filesystem::path& path, const std::string& what, const FileKind& kind) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) fail_with_errno(what, kind);
  check_kind(status, what);
  const int number = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (number < 0) fail_with_errno(what, kind);
  return number;
}

std::uint64_t regular_size(const Descriptor& file, const std::string& what, const FileKind& kind) {
  struct stat status {};
  if (::fstat(file.number(), &status) != 0) fail_with_errno(what, kind);
  check_kind(status, what);
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > kind.max_bytes) {
    fail(what, "is too large ({} bytes; a {} may have {})", grouped(size), kind.name,
         grouped(kind.max_bytes));
  }
  return size;
}

}  // namespace

Bytes read_regular_file(const std::filesystem::path& path, const std::string& what,
                        const FileKind& kind, std::uint64_t count) {
  const Descriptor file(open_regular(path, what, kind));
  Bytes bytes(std::min(regular_size(file, what, kind), count));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t step = ::read(file.number(), bytes.data() + done, bytes.size() - done);
    if (step < 0 && errno == EINTR) continue;
    if (step < 0) fail_with_errno(what, kind);
    if (step == 0) {
      fail(what, "ends early (read {} of {} bytes)", grouped(done), grouped(bytes.size()));
    }
    done += static_cast<std::size_t>(step);
  }
  return bytes;
}

}  // namespace dapple
