// Files that appear whole or not at all. A PendingFile is written beside its target, read
// back by the caller, which knows what it should hold, and only then renamed over the target;
// without commit() it vanishes and the target stays as it was. For every writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace dapple {

/// Refuses, before any work is done, a path that could not be written: not a regular file,
/// read-only, or in a folder that is missing or not writable. Removes from that folder what
/// runs that were killed left there. Throws Error usage.
void check_output_path(const std::string& path);

/// Whether to wait until the disk has it. What can be made again need not: after a power failure
/// its checksum tells.
enum class Durable : bool { no, yes };

/// Every member but the destructor throws Error failed, "cannot write PATH: REASON".
class PendingFile {
 public:
  explicit PendingFile(const std::string& target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  void write(const char* bytes, std::size_t count);
  void seek(std::uint64_t position);
  [[nodiscard]] std::uint64_t position() const { return flushed_ + buffer_.size(); }

  /// Hands everything to the system, and to the disk if `durable`. A write that failed earlier
  /// fails here again, so an encoder that swallows exceptions (OpenEXR's destructor does) cannot
  /// hide it.
  void close(Durable durable = Durable::yes);

  /// The unfinished file, to be verified between close() and commit().
  [[nodiscard]] const std::string& temporary_path() const { return temporary_; }

  /// Renames over the target; close() comes first.
  void commit();

  /// Throws Error failed in the name of the target.
  [[noreturn]] void fail(const std::string& reason);

 private:
  [[noreturn]] void fail_with_errno();
  void flush();

  std::string name_;       // as the caller gave it, for messages
  std::string target_;     // with symbolic links followed: a rename must not replace a link
  std::string temporary_;  // empty once committed
  std::string first_failure_;
  std::string buffer_;         // written after the first `flushed_` bytes
  std::uint64_t flushed_ = 0;  // file position at which `buffer_` begins
  int descriptor_ = -1;
  int lock_ = -1;  // a duplicate: the file stays locked until it has its name
};

/// All of `bytes`, or of the pieces one after the other, as the file `path`, read back before it
/// takes the name. Throws Error failed.
void write_whole_file(const std::string& path, std::string_view bytes);
void write_whole_file(const std::string& path, std::span<const std::string_view> sections);

}  // namespace dapple
