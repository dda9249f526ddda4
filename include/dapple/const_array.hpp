// An array of values that no longer change: from a vector, or from a file that is mapped into
// memory. Copies share the values.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace dapple {

/// Copying is cheap, and so is moving, which leaves the source as it was.
template <class T>
class ConstArray : public std::span<const T> {
 public:
  ConstArray() = default;
  ConstArray(const ConstArray&) = default;
  ConstArray& operator=(const ConstArray&) = default;

  ConstArray(std::vector<T>&& values)  // NOLINT: implicit, a vector that is finished becomes one
      : ConstArray(std::make_shared<const std::vector<T>>(std::move(values))) {}

  /// `keeper` keeps the values in memory.
  ConstArray(std::span<const T> values, std::shared_ptr<const void> keeper)
      : std::span<const T>(values), keeper_(std::move(keeper)) {}

 private:
  explicit ConstArray(std::shared_ptr<const std::vector<T>> values)
      : std::span<const T>(*values), keeper_(std::move(values)) {}

  std::shared_ptr<const void> keeper_;
};

}  // namespace dapple
