// Files that appear completely or not at all; every writer uses them. In: bytes. Out: a finished
// file, or an Error. A PendingFile is written in its target's folder. It is read back and compared
// with what was written, and only then renamed over the target. Without commit() the file is
// removed and the target stays as it was.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <string_view>

#include "files/written_blocks.hpp"

namespace dapple {

/// Refuses a path that cannot be written, before any work is done: not a regular file, read-only,
/// or in a folder that is missing or not writable. Throws Error usage.
void check_output_path(const std::string& path);

/// Removes temporary files of killed runs from the folder of `path`.
void remove_abandoned_beside(const std::string& path);

/// Whether to wait until the disk has the file. Files that can be made again need not wait: their
/// checksum shows damage after a power failure.
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

  /// Writes everything to the system, and to the disk if `durable`. If an earlier write failed,
  /// fails with its reason, so that an encoder that swallows exceptions (as OpenEXR's destructor
  /// does) cannot hide it.
  void close(Durable durable = Durable::yes);

  /// Reads the file back, between close() and commit(), and fails if it differs from what was
  /// written. By checksums of blocks.
  void verify();

  /// Path of the unfinished file.
  [[nodiscard]] const std::string& temporary_path() const { return temporary_; }

  /// Renames the file over the target. close() must come first.
  void commit();

  /// Throws Error failed, which names the target and the first reason that was given.
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
  WrittenBlocks written_;
  int descriptor_ = -1;
  int lock_ = -1;  // duplicate that keeps the file locked after close()
};

/// Removes a symbolic link, so that what is written to the path does not go where it leads: names
/// in a cache are chosen by dapple, and others may write there.
void remove_link(const std::string& path);

/// Files that belong together. None gets its name before all are written, so that a full disk
/// leaves neither some of them nor new ones beside old ones.
class PendingFiles {
 public:
  /// A file to write, which the caller closes and verifies. Throws Error failed.
  PendingFile& add(const std::string& path) { return files_.emplace_back(path); }
  /// Writes `bytes` for the file `path` and verifies them. Throws Error failed.
  void add(const std::string& path, std::string_view bytes);
  /// Gives all files their names, in the order of add(). Throws Error failed.
  void commit();

 private:
  std::deque<PendingFile> files_;
};

/// Writes `bytes`, or the sections one after the other, as the file `path`, and verifies them by
/// reading them back before the file gets its name. Throws Error failed.
void write_whole_file(const std::string& path, std::string_view bytes);
void write_whole_file(const std::string& path, std::span<const std::string_view> sections);

}  // namespace dapple
