// Memory of the arrays that rays read at random. In: a number of values. Out: memory, in pages of
// 2 MB where the system has them (Linux's transparent huge pages). With pages of 4 kB a visit of a
// node of a large scene often misses the TLB, too (experiment 129). Small arrays have usual memory.
#pragma once

#include <sys/mman.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

namespace dapple {

template <class T>
struct LargePages {
  using value_type = T;

  LargePages() = default;
  template <class U>
  LargePages(const LargePages<U>&) {}  // NOLINT: containers convert allocators

  T* allocate(std::size_t count) {
    if (!is_large(count)) return std::allocator<T>().allocate(count);
    const std::size_t bytes = (count * sizeof(T) + kPage - 1) / kPage * kPage;
    void* memory = std::aligned_alloc(kPage, bytes);
    if (!memory) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    madvise(memory, bytes, MADV_HUGEPAGE);  // if it is refused, pages stay small
#endif
    map_pages(static_cast<std::byte*>(memory), bytes);
    return static_cast<T*>(memory);
  }

  void deallocate(T* memory, std::size_t count) {
    if (is_large(count))
      std::free(memory);
    else
      std::allocator<T>().deallocate(memory, count);
  }

  template <class U>
  bool operator==(const LargePages<U>&) const {
    return true;
  }

 private:
  static constexpr std::size_t kPage = std::size_t{1} << 21;

  /// Writes to each page in parallel. The system clears a page at its first write, which would else
  /// happen in the one thread that constructs the values.
  static void map_pages(std::byte* memory, std::size_t bytes) {
    tbb::parallel_for(std::size_t{0}, bytes / kPage,
                      [&](std::size_t page) { memory[page * kPage] = std::byte{0}; });
  }

  /// Whether less than a fifth is lost when the last page is partly used.
  static bool is_large(std::size_t count) { return count > 4 * kPage / sizeof(T); }
};

/// A std::vector whose memory has large pages.
template <class T>
using LargeVector = std::vector<T, LargePages<T>>;

}  // namespace dapple
