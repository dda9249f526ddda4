// Runs the kernels of tests/kernels, which call the product's device functions. In: arrays of
// values; out: arrays of values.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "device/context.hpp"

namespace dapple::kernel_test {

/// The best device; it looks for kernels in tests/kernels first. Opened once per process, because
/// that is slow.
inline DeviceContext& device() {
  static DeviceContext context("", DAPPLE_TEST_KERNELS);
  return context;
}

/// A copy of `values` in device memory.
template <class T>
Buffer upload(const std::vector<T>& values) {
  Buffer buffer = device().allocate(values.size() * sizeof(T));
  device().write(buffer, values.data(), values.size() * sizeof(T));
  return buffer;
}

template <class T>
std::vector<T> download(const Buffer& buffer, std::size_t count) {
  std::vector<T> values(count);
  device().read(buffer, values.data(), count * sizeof(T));
  return values;
}

inline void run(const std::string& file, const std::string& kernel, std::size_t items,
                const std::vector<KernelArgument>& arguments) {
  device().launch({kernel, file, {}}, kernel, items, arguments);
  device().finish();
}

}  // namespace dapple::kernel_test
