#include "device/page_pool.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>

#include "dapple/error.hpp"

namespace dapple {
namespace {

constexpr std::size_t kPage = 4096;

/// Rounds up to whole pages, and to a sixteenth of the next power of two, so that later requests
/// often have the same size.
std::size_t rounded(std::size_t bytes) {
  const std::size_t step = std::max(kPage, std::bit_ceil(bytes) / 16);
  return (bytes + step - 1) / step * step;
}

/// Bytes that a thread clears at a time.
constexpr std::size_t kClearedTogether = std::size_t{1} << 18;

void clear(const Pages& pages) {
  auto* bytes = static_cast<std::byte*>(pages.data());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pages.bytes(), kClearedTogether),
                    [&](const tbb::blocked_range<std::size_t>& part) {
                      std::memset(bytes + part.begin(), 0, part.size());
                    });
}

}  // namespace

Pages::Pages(std::size_t bytes)
    : data_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)),
      bytes_(bytes) {
  if (data_ == MAP_FAILED) throw std::bad_alloc();
}

Pages::~Pages() { munmap(data_, bytes_); }

std::unique_ptr<Pages> PagePool::find(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(kept_.begin(), kept_.end(),
                                  [&](const auto& pages) { return pages->bytes() == bytes; });
  if (found == kept_.end()) return nullptr;
  std::unique_ptr<Pages> pages = std::move(*found);
  kept_.erase(found);
  kept_bytes_ -= bytes;
  return pages;
}

std::unique_ptr<Pages> PagePool::make(std::size_t bytes) {
  try {
    return std::make_unique<Pages>(bytes);
  } catch (const std::bad_alloc&) {
    const std::lock_guard lock(mutex_);
    kept_.clear();
    kept_bytes_ = 0;
  }
  try {
    return std::make_unique<Pages>(bytes);
  } catch (const std::bad_alloc&) {
    throw Error(
        ErrorKind::device,
        fmt::format("allocating {} bytes that host and device share: out of memory", bytes));
  }
}

std::unique_ptr<Pages> PagePool::take(std::size_t bytes) {
  std::unique_ptr<Pages> pages = find(rounded(bytes));
  return pages ? std::move(pages) : make(rounded(bytes));
}

std::unique_ptr<Pages> PagePool::take_zeros(std::size_t bytes) {
  std::unique_ptr<Pages> pages = find(rounded(bytes));
  if (!pages) return make(rounded(bytes));
  clear(*pages);
  return pages;
}

// OpenCL's threads call this from C code, so it must not throw.
void PagePool::give_back(std::unique_ptr<Pages> pages) noexcept {
  const std::size_t bytes = pages->bytes();
  const std::lock_guard lock(mutex_);
  try {
    kept_.push_back(std::move(pages));
  } catch (const std::bad_alloc&) {
    return;
  }
  for (kept_bytes_ += bytes; kept_bytes_ > kMaxKept; kept_.pop_front())
    kept_bytes_ -= kept_.front()->bytes();
}

}  // namespace dapple
