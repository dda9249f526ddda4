// The largest alphas of a texture's parts: where there is nothing at all.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Answers "is there anything in this part of the texture". Keeps the texture by address.
class TexelMaxima {
 public:
  explicit TexelMaxima(const Texture& texture);

  /// Whether the texels between the coordinates `from` and `to`, from <= to, or those around that
  /// bilinear lookups and rounding mix in, may be `least` or more, 0 to 255. Never wrongly no.
  [[nodiscard]] bool may_reach(V2f from, V2f to, int least) const;

 private:
  /// Squares of 2^k texels, `width` a row.
  struct Level {
    int width, height;
    std::vector<std::uint8_t> most;  ///< of level 0, which is the texture, none
  };
  /// Texels first to last of an axis, inclusive.
  struct Range {
    int first, last;
  };
  [[nodiscard]] bool reaches(Range columns, Range rows, int least) const;

  const Texture& texture_;
  std::vector<Level> levels_;
};

}  // namespace dapple
