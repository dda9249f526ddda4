// Checksums by XXH3 with 128 bits, for the contents of sealed files and the names of cached ones.
// In: bytes, all at once or in parts. Out: a checksum. It detects damage, not forgery.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace dapple {

using Checksum = std::array<std::uint64_t, 2>;

Checksum checksum(std::string_view bytes);

/// 32 hexadecimal digits.
std::string hex_text(const Checksum& checksum);

class ChecksumStream {
 public:
  ChecksumStream();
  ~ChecksumStream();
  ChecksumStream(const ChecksumStream&) = delete;
  ChecksumStream& operator=(const ChecksumStream&) = delete;

  void add(std::span<const std::byte> bytes);

  /// Adds the bytes of a plain value without padding.
  template <class T>
  requires std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>
  void add_value(const T& value) { add(std::as_bytes(std::span(&value, 1))); }

  /// Adds the number of values, and their bytes.
  template <class Range>
  void add_range(const Range& values) {
    add_value(static_cast<std::uint64_t>(std::size(values)));
    add(std::as_bytes(std::span(std::data(values), std::size(values))));
  }

  [[nodiscard]] Checksum value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dapple
