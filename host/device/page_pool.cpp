#include "device/page_pool.hpp"

#include <sys/mman.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <new>

namespace dapple {
namespace {

/// Bytes kept: two megapixels of film with a light.
constexpr std::size_t kMostKept = std::size_t{512} << 20;

/// Bytes that a thread clears in one go.
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

std::unique_ptr<Pages> PagePool::take(std::size_t bytes) {
  std::unique_ptr<Pages> pages = find(bytes);
  return pages ? std::move(pages) : std::make_unique<Pages>(bytes);
}

std::unique_ptr<Pages> PagePool::take_zeros(std::size_t bytes) {
  std::unique_ptr<Pages> pages = find(bytes);
  if (!pages) return std::make_unique<Pages>(bytes);
  clear(*pages);
  return pages;
}

void PagePool::give_back(std::unique_ptr<Pages> pages) {
  const std::lock_guard lock(mutex_);
  if (kept_bytes_ + pages->bytes() > kMostKept) return;
  kept_bytes_ += pages->bytes();
  kept_.push_back(std::move(pages));
}

}  // namespace dapple
