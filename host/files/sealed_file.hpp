// Files that dapple writes and reads back: caches and checkpoints. A header states the kind,
// version and size of the file; a checksum covers every byte. In: sections of plain data. Out: the
// same sections, mapped into memory, or an Error that names the file and its damage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "files/output_file.hpp"

namespace dapple {

/// The name of a kind of file, at most 15 characters, and the version of its sections' layout.
struct SealedKind {
  std::string_view name;
  std::uint32_t version = 0;
};

/// A section of a sealed file: plain data in this machine's byte order.
using Section = std::span<const std::byte>;

/// Maximum number of sections in a file.
inline constexpr std::size_t kMaxSections = 1024;

/// Sections begin at multiples of this many bytes.
inline constexpr std::size_t kSectionAlignment = 128;

/// Plain values as a section, which points to them: they must outlive it.
template <class Range>
Section as_section(const Range& values) {
  static_assert(
      std::is_trivially_copyable_v<std::remove_reference_t<decltype(*std::data(values))>>);
  return std::as_bytes(std::span(std::data(values), std::size(values)));
}

/// Writes a temporary file in the same folder, reads it back, checks it and renames it to `path`:
/// there is always the old file or the whole new one. Throws Error failed, "cannot write PATH:
/// REASON"; with more than kMaxSections sections it writes nothing.
void write_sealed_file(const std::string& path, const SealedKind& kind,
                       std::span<const Section> sections, Durable durable = Durable::yes);
void write_sealed_file(const std::string& path, const SealedKind& kind,
                       std::initializer_list<Section> sections, Durable durable = Durable::yes);

/// A sealed file in memory. Copies share the memory. It does not change when the file is replaced
/// or removed.
class SealedFile {
 public:
  [[nodiscard]] std::size_t section_count() const { return sections_.size(); }
  [[nodiscard]] Section section(std::size_t index) const;

  /// The values of a section. Throws Error input when there is no such section, or its size is not
  /// a multiple of a value's.
  template <class T>
  [[nodiscard]] std::span<const T> values(std::size_t index) const {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kSectionAlignment);
    const Section bytes = section_of(index, sizeof(T));
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }

  /// Keeps the sections in memory after the last SealedFile of them is destroyed.
  [[nodiscard]] std::shared_ptr<const void> keeper() const { return mapping_; }

 private:
  friend SealedFile open_sealed_file(const std::string& path, const SealedKind& kind);
  [[nodiscard]] Section section_of(std::size_t index, std::size_t value_bytes) const;

  std::string path_;
  std::shared_ptr<const void> mapping_;
  std::vector<Section> sections_;
};

/// Opens a sealed file and checks all of it. Throws Error input, "PATH: ...", when the file is
/// missing, damaged, or of another kind or version.
SealedFile open_sealed_file(const std::string& path, const SealedKind& kind);

}  // namespace dapple
