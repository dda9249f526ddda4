#include "render/partial/pieces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
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

/// From the first to the last ray of any piece.
RayRange all_rays(const std::vector<Piece>& pieces) {
  RayRange all = pieces.front().rays;
  for (const Piece& piece : pieces)
    all = {std::min(all.first, piece.rays.first), std::max(all.end, piece.rays.end)};
  return all;
}

std::uint64_t volume(const PixelRect& rect, const RayRange& rays) {
  return area(rect) * (rays.end - rays.first);
}

/// Whether pieces that do not overlap are all rays of all pixels of their box, however they lie.
bool fills_box(const std::vector<Piece>& pieces) {
  std::uint64_t sum = 0;
  for (const Piece& piece : pieces) sum += volume(piece.rect, piece.rays);
  return sum == volume(box_of(pieces), all_rays(pieces));
}

/// Ranges of [0, spp) that are not in `ranges`.
std::vector<RayRange> gaps(std::vector<RayRange> ranges, std::uint32_t spp) {
  std::sort(ranges.begin(), ranges.end(),
            [](const RayRange& a, const RayRange& b) { return a.first < b.first; });
  std::vector<RayRange> found;
  std::uint32_t next = 0;
  for (const RayRange& range : ranges) {
    if (range.first > next) found.push_back({next, range.first});
    next = range.end;
  }
  if (next < spp) found.push_back({next, spp});
  return found;
}

/// Where the intervals of pieces along an axis begin, and where the last one ends, sorted.
std::vector<int> edges_of(const std::vector<Piece>& pieces, int PixelRect::*first,
                          int PixelRect::*last) {
  std::vector<int> edges;
  for (const Piece& piece : pieces) {
    edges.push_back(piece.rect.*first);
    edges.push_back(piece.rect.*last + 1);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<Piece> touching(const std::vector<Piece>& pieces, const PixelRect& rect) {
  std::vector<Piece> found;
  std::copy_if(pieces.begin(), pieces.end(), std::back_inserter(found),
               [&](const Piece& piece) { return intersect(piece.rect, rect); });
  return found;
}

/// What pieces that do not overlap lack of their box: gaps of the cells between their edges,
/// joined.
std::vector<Piece> holes(const std::vector<Piece>& pieces, std::uint32_t spp) {
  const PixelRect box = box_of(pieces);
  std::vector<Piece> found;
  const std::vector<int> ys = edges_of(pieces, &PixelRect::y0, &PixelRect::y1);
  for (std::size_t y = 0; y + 1 < ys.size(); ++y) {
    const PixelRect strip{box.x0, ys[y], box.x1, ys[y + 1] - 1};
    const std::vector<Piece> row = touching(pieces, strip);
    std::vector<int> xs = edges_of(row, &PixelRect::x0, &PixelRect::x1);
    for (const int end : {box.x0, box.x1 + 1})
      if (std::find(xs.begin(), xs.end(), end) == xs.end()) xs.push_back(end);
    std::sort(xs.begin(), xs.end());
    for (std::size_t x = 0; x + 1 < xs.size(); ++x) {
      const PixelRect cell{xs[x], strip.y0, xs[x + 1] - 1, strip.y1};
      std::vector<RayRange> ranges;
      for (const Piece& piece : touching(row, cell)) ranges.push_back(piece.rays);
      for (const RayRange& gap : gaps(std::move(ranges), spp)) found.push_back({cell, gap});
    }
  }
  return joined(std::move(found));
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
  if (pieces.size() > 1 && fills_box(pieces)) return {{box_of(pieces), all_rays(pieces)}};
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
  const PixelRect box = box_of(pieces);
  std::map<std::tuple<int, int, int, int>, std::vector<std::string>> by_rect;
  std::uint64_t empty = 0;  // pixels
  for (const auto& [rect, rays] : holes(joined(pieces), spp)) {
    if (rays == RayRange{0, spp})
      empty += area(rect);
    else
      by_rect[{rect.y0, rect.x0, rect.y1, rect.x1}].push_back(rays_text(rays));
  }
  std::vector<std::string> texts;
  for (const auto& [corners, lacks] : by_rect) {
    const auto [y0, x0, y1, x1] = corners;
    const PixelRect rect{x0, y0, x1, y1};
    const std::string where = rect == box ? "" : fmt::format(" of the pixels {}", rect_text(rect));
    texts.push_back(fmt::format("{} of {}{}", fmt::join(lacks, ", "), spp, where));
  }
  if (empty > 0) texts.push_back(fmt::format("{} of {} pixels", empty, area(box)));
  return fmt::format("{}", fmt::join(texts, "; "));
}

}  // namespace dapple
