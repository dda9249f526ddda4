// Memory that device and host share, kept between pictures: a page that the operating system
// brings for the first time takes as long as a dozen rays.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>

namespace dapple {

/// Pages of the operating system, mapped for reading and writing.
class Pages {
 public:
  /// Zeros, brought as they are first written to. Throws std::bad_alloc.
  explicit Pages(std::size_t bytes);
  Pages(const Pages&) = delete;
  Pages& operator=(const Pages&) = delete;
  ~Pages();
  [[nodiscard]] void* data() const { return data_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  void* data_;
  std::size_t bytes_;
};

/// May be used by several threads.
class PagePool {
 public:
  /// Bytes kept at most; beyond, those kept longest go.
  static constexpr std::size_t kMaxKept = std::size_t{512} << 20;

  /// `bytes` or up to an eighth more: pages that were given back, or new ones. Throws Error device.
  std::unique_ptr<Pages> take(std::size_t bytes);
  /// The same, full of zeros.
  std::unique_ptr<Pages> take_zeros(std::size_t bytes);
  void give_back(std::unique_ptr<Pages> pages) noexcept;

 private:
  /// Kept ones of that size; null if there are none.
  std::unique_ptr<Pages> find(std::size_t bytes);
  /// New ones, if need be in place of all that are kept.
  std::unique_ptr<Pages> make(std::size_t bytes);

  std::mutex mutex_;
  std::deque<std::unique_ptr<Pages>> kept_;  ///< the last given back at the end
  std::size_t kept_bytes_ = 0;
};

}  // namespace dapple
