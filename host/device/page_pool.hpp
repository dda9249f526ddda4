// Memory that device and host share, kept from one picture to the next, because the first access to
// a new page of the operating system is slow. In: a number of bytes. Out: pages of at least that
// size.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>

namespace dapple {

/// Pages of the operating system, mapped for reading and writing.
class Pages {
 public:
  /// Maps `bytes` of zeros; the system allocates each page at its first use. Throws std::bad_alloc.
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

/// Several threads may use it at once.
class PagePool {
 public:
  /// Maximum number of bytes kept; beyond, the pages that were kept longest are freed.
  static constexpr std::size_t kMaxKept = std::size_t{512} << 20;

  /// At least `bytes`, at most an eighth or a page more: pages that were given back, or new ones.
  /// Throws Error device.
  std::unique_ptr<Pages> take(std::size_t bytes);
  /// The same, full of zeros.
  std::unique_ptr<Pages> take_zeros(std::size_t bytes);
  /// Keeps `pages` for later requests.
  void give_back(std::unique_ptr<Pages> pages) noexcept;

 private:
  /// Kept pages of that size; null if there are none.
  std::unique_ptr<Pages> find(std::size_t bytes);
  /// New pages. If memory runs out, frees all kept ones first. Throws Error device.
  std::unique_ptr<Pages> make(std::size_t bytes);

  std::mutex mutex_;
  std::deque<std::unique_ptr<Pages>> kept_;  ///< in the order in which they were given back
  std::size_t kept_bytes_ = 0;
};

}  // namespace dapple
