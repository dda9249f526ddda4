// What a file should hold, to check it when it is complete. In: the blocks of bytes that are
// written, in turn. Out: whether the file holds them. Costs 32 bytes of memory for each block.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "files/checksum.hpp"

namespace dapple {

class WrittenBlocks {
 public:
  /// `bytes` are about to be written at `position`, which is not beyond the end so far. They may
  /// replace bytes of earlier blocks, which are then read from the open file. False: these differ
  /// from what was written.
  [[nodiscard]] bool add(int descriptor, std::uint64_t position, std::string_view bytes);

  /// Whether the file consists of the blocks and nothing else.
  [[nodiscard]] bool are_in(const std::string& path) const;

 private:
  struct Block {
    std::uint64_t position, size;
    Checksum checksum;
  };
  std::vector<Block> blocks_;  ///< one after the other
  std::uint64_t end_ = 0;
};

}  // namespace dapple
