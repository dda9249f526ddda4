// An array of constant values, from a vector or from a file that is mapped into memory. Copies
// share the values.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace dapple {

/// Copies and moves are cheap. A move leaves the source unchanged.
template <class T>
class ConstArray : public std::span<const T> {
 public:
  ConstArray() = default;
  ConstArray(const ConstArray&) = default;
  ConstArray& operator=(const ConstArray&) = default;

  template <class Allocator>
  ConstArray(std::vector<T, Allocator>&& values)  // NOLINT: implicit conversion is wanted
      : ConstArray(std::make_shared<const std::vector<T, Allocator>>(std::move(values))) {}

  /// `keeper` owns the memory of the values.
  ConstArray(std::span<const T> values, std::shared_ptr<const void> keeper)
      : std::span<const T>(values), keeper_(std::move(keeper)) {}

 private:
  template <class Allocator>
  explicit ConstArray(std::shared_ptr<const std::vector<T, Allocator>> values)
      : std::span<const T>(*values), keeper_(std::move(values)) {}

  std::shared_ptr<const void> keeper_;
};

}  // namespace dapple
