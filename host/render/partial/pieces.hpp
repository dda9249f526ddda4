// Which samples of which pixels a file of sums has. In: pieces, each a rectangle of pixels and a
// range of camera rays. Out: whether they overlap, what is missing, and the same in fewer pieces.
#pragma once

#include <string>
#include <vector>

#include "dapple/options.hpp"
#include "sampling/shard.hpp"

namespace dapple {

struct Piece {
  PixelRect rect;
  RayRange rays;
  bool operator==(const Piece&) const = default;
};

/// Whether the rectangle lies in `crop`, and the range is one that a picture has.
[[nodiscard]] bool is_piece_of(const PixelRect& crop, const Piece& piece);

[[nodiscard]] bool overlap(const Piece& a, const Piece& b);

/// The same samples in fewer pieces: neighbours in rays, columns or rows become one. In an order
/// that does not depend on that of `pieces`, which must not overlap.
[[nodiscard]] std::vector<Piece> joined(std::vector<Piece> pieces);

/// The smallest rectangle around all of them; there must be one.
[[nodiscard]] PixelRect box_of(const std::vector<Piece>& pieces);

/// "sample 9" or "samples 9 to 12": users count from 1.
[[nodiscard]] std::string rays_text(const RayRange& rays);

/// "9,0 to 18,4": corners of a rectangle.
[[nodiscard]] std::string rect_text(const PixelRect& rect);

/// What pieces lack to `spp` samples of every pixel of their box, in a few words, or "". They must
/// not overlap.
[[nodiscard]] std::string missing_text(const std::vector<Piece>& pieces, std::uint32_t spp);

}  // namespace dapple
