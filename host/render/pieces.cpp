#include "render/pieces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace dapple {
namespace {

/// Joins neighbours in a list that is sorted so that they follow each other. `follows(a, b)`: b
/// begins where a ends and is the same otherwise; `extend(a, b)` makes a of both.
template <class Key, class Follows, class Extend>
void join(std::vector<Piece>& pieces, const Key& key, const Follows& follows,
          const Extend& extend) {
  std::sort(pieces.begin(), pieces.end(),
            [&](const Piece& a, const Piece& b) { return key(a) < key(b); });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < pieces.size(); ++i) {
    if (follows(pieces[kept], pieces[i]))
      extend(pieces[kept], pieces[i]);
    else
      pieces[++kept] = pieces[i];
  }
  if (!pieces.empty()) pieces.resize(kept + 1);
}

void join_rays(std::vector<Piece>& pieces) {
  join(
      pieces,
      [](const Piece& p) {
        return std::tuple(p.rect.y0, p.rect.x0, p.rect.y1, p.rect.x1, p.rays.first);
      },
      [](const Piece& a, const Piece& b) { return a.rect == b.rect && a.rays.end == b.rays.first; },
      [](Piece& a, const Piece& b) { a.rays.end = b.rays.end; });
}

void join_columns(std::vector<Piece>& pieces) {
  join(
      pieces,
      [](const Piece& p) {
        return std::tuple(p.rays.first, p.rays.end, p.rect.y0, p.rect.y1, p.rect.x0);
      },
      [](const Piece& a, const Piece& b) {
        return a.rays == b.rays && a.rect.y0 == b.rect.y0 && a.rect.y1 == b.rect.y1 &&
               a.rect.x1 + 1 == b.rect.x0;
      },
      [](Piece& a, const Piece& b) { a.rect.x1 = b.rect.x1; });
}

void join_rows(std::vector<Piece>& pieces) {
  join(
      pieces,
      [](const Piece& p) {
        return std::tuple(p.rays.first, p.rays.end, p.rect.x0, p.rect.x1, p.rect.y0);
      },
      [](const Piece& a, const Piece& b) {
        return a.rays == b.rays && a.rect.x0 == b.rect.x0 && a.rect.x1 == b.rect.x1 &&
               a.rect.y1 + 1 == b.rect.y0;
      },
      [](Piece& a, const Piece& b) { a.rect.y1 = b.rect.y1; });
}

std::uint64_t area(const PixelRect& rect) {
  return static_cast<std::uint64_t>(rect.width()) * static_cast<std::uint64_t>(rect.height());
}

bool intersect(const PixelRect& a, const PixelRect& b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

/// Ranges of [0, spp) that are not in `ranges`, which are sorted.
std::vector<std::string> gaps(const std::vector<RayRange>& ranges, std::uint32_t spp) {
  std::vector<std::string> texts;
  std::uint32_t next = 0;
  for (const RayRange& range : ranges) {
    if (range.first > next) texts.push_back(rays_text({next, range.first}));
    next = range.end;
  }
  if (next < spp) texts.push_back(rays_text({next, spp}));
  return texts;
}

}  // namespace

bool is_piece_of(const PixelRect& crop, const Piece& piece) {
  constexpr std::uint32_t kMaxRays = 1u << 20;
  const auto& [rect, rays] = piece;
  return rect.x0 >= crop.x0 && rect.y0 >= crop.y0 && rect.x0 <= rect.x1 && rect.y0 <= rect.y1 &&
         rect.x1 <= crop.x1 && rect.y1 <= crop.y1 && rays.first < rays.end && rays.end <= kMaxRays;
}

bool overlap(const Piece& a, const Piece& b) {
  return intersect(a.rect, b.rect) && a.rays.first < b.rays.end && b.rays.first < a.rays.end;
}

std::vector<Piece> joined(std::vector<Piece> pieces) {
  for (std::size_t before = pieces.size() + 1; pieces.size() < before;) {
    before = pieces.size();
    join_columns(pieces);
    join_rows(pieces);
    join_rays(pieces);
  }
  return pieces;
}

PixelRect box_of(const std::vector<Piece>& pieces) {
  PixelRect box = pieces.front().rect;
  for (const Piece& piece : pieces) {
    box = {std::min(box.x0, piece.rect.x0), std::min(box.y0, piece.rect.y0),
           std::max(box.x1, piece.rect.x1), std::max(box.y1, piece.rect.y1)};
  }
  return box;
}

std::string rays_text(const RayRange& rays) {
  if (rays.end == rays.first + 1) return fmt::format("sample {}", rays.end);
  return fmt::format("samples {} to {}", rays.first + 1, rays.end);
}

std::string rect_text(const PixelRect& rect) {
  return fmt::format("{},{} to {},{}", rect.x0, rect.y0, rect.x1, rect.y1);
}

std::string missing_text(const std::vector<Piece>& pieces, std::uint32_t spp) {
  std::map<std::tuple<int, int, int, int>, std::vector<RayRange>> by_rect;
  for (const Piece& piece : joined(pieces)) {
    const PixelRect& r = piece.rect;
    by_rect[{r.y0, r.x0, r.y1, r.x1}].push_back(piece.rays);
  }
  const PixelRect box = box_of(pieces);
  std::vector<std::string> texts;
  std::uint64_t covered = 0;
  for (auto& [corners, ranges] : by_rect) {
    const auto [y0, x0, y1, x1] = corners;
    const PixelRect rect{x0, y0, x1, y1};
    covered += area(rect);
    std::sort(ranges.begin(), ranges.end(),
              [](const RayRange& a, const RayRange& b) { return a.first < b.first; });
    const std::vector<std::string> lacks = gaps(ranges, spp);
    if (lacks.empty()) continue;
    const std::string where = rect == box ? "" : fmt::format(" of the pixels {}", rect_text(rect));
    texts.push_back(fmt::format("{} of {}{}", fmt::join(lacks, ", "), spp, where));
  }
  if (covered < area(box))
    texts.push_back(fmt::format("{} of {} pixels", area(box) - covered, area(box)));
  return fmt::format("{}", fmt::join(texts, "; "));
}

}  // namespace dapple
