#include "files/written_blocks.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>

namespace dapple {
namespace {

/// The bytes at `position`; fewer at the end of the file, or where reading fails.
std::string read_at(int descriptor, std::uint64_t position, std::uint64_t size) {
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t step =
        pread(descriptor, bytes.data() + done, size - done, static_cast<off_t>(position + done));
    if (step < 0 && errno == EINTR) continue;
    if (step <= 0) break;
    done += static_cast<std::size_t>(step);
  }
  bytes.resize(done);
  return bytes;
}

}  // namespace

bool WrittenBlocks::add(int descriptor, std::uint64_t position, std::string_view bytes) {
  assert(position <= end_);
  const std::uint64_t end = position + bytes.size();
  for (Block& block : blocks_) {
    const std::uint64_t first = std::max(block.position, position),
                        last = std::min(block.position + block.size, end);
    if (first >= last) continue;
    std::string held = read_at(descriptor, block.position, block.size);
    if (checksum(held) != block.checksum) return false;
    held.replace(first - block.position, last - first,
                 bytes.substr(first - position, last - first));
    block.checksum = checksum(held);
  }
  if (end > end_) {
    const std::string_view more = bytes.substr(end_ - position);
    blocks_.push_back({end_, more.size(), checksum(more)});
    end_ = end;
  }
  return true;
}

bool WrittenBlocks::are_in(const std::string& path) const {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool match = std::all_of(blocks_.begin(), blocks_.end(), [&](const Block& block) {
    return checksum(read_at(descriptor, block.position, block.size)) == block.checksum;
  });
  const bool ends = read_at(descriptor, end_, 1).empty();
  ::close(descriptor);
  return match && ends;
}

}  // namespace dapple
