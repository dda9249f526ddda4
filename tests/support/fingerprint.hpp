// A hash of plain values, the same on every machine: 64-bit FNV-1a (Fowler, Noll and Vo). In:
// bytes; out: a number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dapple {

class Fingerprint {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    add_bytes(values.data(), values.size() * sizeof(T));
  }
  void add_bytes(const void* data, std::size_t count) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < count; ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3u;
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace dapple
