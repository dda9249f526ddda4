// Files of ours that are read back: caches and checkpoints. A header says what the file is, in
// which version and how large; a checksum over every byte seals it. In: sections of plain data.
// Out: the same sections, mapped into memory, or an Error that names the file and its damage.
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

/// What a file holds, at most 15 characters, and the version of its sections' layout.
struct SealedKind {
  std::string_view name;
  std::uint32_t version = 0;
};

/// A section of a sealed file: plain data in this machine's byte order.
using Section = std::span<const std::byte>;

/// Sections of a file at most.
inline constexpr std::size_t kMaxSections = 1024;

/// Sections begin at multiples of this many bytes.
inline constexpr std::size_t kSectionAlignment = 128;

/// Values that can be copied byte by byte, as a section. They must outlive it.
template <class Range>
Section as_section(const Range& values) {
  static_assert(
      std::is_trivially_copyable_v<std::remove_reference_t<decltype(*std::data(values))>>);
  return std::as_bytes(std::span(std::data(values), std::size(values)));
}

/// Written beside, read back and checked, renamed: the old file or the new one is there, never a
/// part. Throws Error failed, "cannot write PATH: REASON"; before it writes when there are too many
/// sections.
void write_sealed_file(const std::string& path, const SealedKind& kind,
                       std::span<const Section> sections, Durable durable = Durable::yes);
void write_sealed_file(const std::string& path, const SealedKind& kind,
                       std::initializer_list<Section> sections, Durable durable = Durable::yes);

/// A sealed file in memory, which the copies of this share. Replacing or removing the file does
/// not change what they see.
class SealedFile {
 public:
  [[nodiscard]] std::size_t section_count() const { return sections_.size(); }
  [[nodiscard]] Section section(std::size_t index) const;

  /// A section as the values that it was made of. Throws Error input when it is not there or its
  /// size is no multiple of theirs.
  template <class T>
  [[nodiscard]] std::span<const T> values(std::size_t index) const {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kSectionAlignment);
    const Section bytes = section_of(index, sizeof(T));
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }

  /// Keeps the sections in memory after this has gone.
  [[nodiscard]] std::shared_ptr<const void> keeper() const { return mapping_; }

 private:
  friend SealedFile open_sealed_file(const std::string& path, const SealedKind& kind);
  [[nodiscard]] Section section_of(std::size_t index, std::size_t value_bytes) const;

  std::string path_;
  std::shared_ptr<const void> mapping_;
  std::vector<Section> sections_;
};

/// Opens and checks all of a sealed file. Throws Error input, "PATH: ...", when there is none, or
/// it is of another kind or version, or damaged.
SealedFile open_sealed_file(const std::string& path, const SealedKind& kind);

}  // namespace dapple
