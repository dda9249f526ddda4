#include "bake/texture/charts.hpp"

#include <Imath/ImathBox.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bake/samples/surface_samples.hpp"

namespace dapple {
namespace {

/// The least cosine between the normal of a triangle and the mean normal of its chart so far.
constexpr float kMinCosine = 0.6f;

/// Directions within a quarter turn that are tried for a chart's bounding rectangle.
constexpr int kTurns = 16;

/// A chart is rasterized to a grid of this many cells each way to see whether it overlaps itself.
constexpr int kGrid = 64;

/// The share of a chart's cells above which an overlap counts.
constexpr double kMaxOverlap = 0.02;

/// Rectangles of parts over that of the whole, from which on a division is not worth its seam.
constexpr float kWorthDividing = 0.75f;

struct Edge {
  std::uint64_t vertices;  ///< two vertex groups, the smaller one in the upper half
  std::uint32_t triangle;
  bool operator<(const Edge& other) const {
    return vertices != other.vertices ? vertices < other.vertices : triangle < other.triangle;
  }
};

/// For each triangle its neighbours across edges.
class Neighbours {
 public:
  explicit Neighbours(const Mesh& mesh) : of_(mesh.primitive_count(), {kNone, kNone, kNone}) {
    const VertexGroups groups = group_vertices(mesh);
    std::vector<Edge> edges;
    edges.reserve(mesh.indices.size());
    for (std::uint32_t t = 0; t < of_.size(); ++t) {
      if (!has_area(mesh, t)) continue;  // its neighbours are those of each other
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint64_t a = groups.of_vertex[mesh.indices[3 * t + k]];
        const std::uint64_t b = groups.of_vertex[mesh.indices[3 * t + (k + 1) % 3]];
        if (a != b) edges.push_back({std::min(a, b) << 32 | std::max(a, b), t});
      }
    }
    std::sort(edges.begin(), edges.end());
    // Of an edge of many triangles, consecutive ones are neighbours.
    for (std::size_t i = 1; i < edges.size(); ++i) {
      if (edges[i].vertices != edges[i - 1].vertices) continue;
      add(edges[i].triangle, edges[i - 1].triangle);
      add(edges[i - 1].triangle, edges[i].triangle);
    }
  }

  static constexpr std::uint32_t kNone = ~0u;
  [[nodiscard]] const std::array<std::uint32_t, 3>& of(std::uint32_t t) const { return of_[t]; }

 private:
  void add(std::uint32_t triangle, std::uint32_t neighbour) {
    for (std::uint32_t& slot : of_[triangle]) {
      if (slot != kNone) continue;
      slot = neighbour;
      return;
    }
  }

  std::vector<std::array<std::uint32_t, 3>> of_;
};

/// Connected triangles from `seed` on whose normals are close to their mean. Marks them as taken.
std::vector<std::uint32_t> grow(const Mesh& mesh, const Neighbours& neighbours, std::uint32_t seed,
                                std::vector<bool>& taken) {
  std::vector<std::uint32_t> triangles{seed};
  taken[seed] = true;
  V3f sum = area_vector(mesh, seed);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t t : neighbours.of(triangles[i])) {
      if (t == Neighbours::kNone || taken[t]) continue;
      const V3f area = area_vector(mesh, t);
      if (area.normalized().dot(sum.normalized()) < kMinCosine) continue;
      taken[t] = true;
      triangles.push_back(t);
      sum += area;
    }
  }
  return triangles;
}

/// Turns the corners so that their bounding rectangle is small, and moves it to the origin.
void fit_rectangle(Chart& chart) {
  Imath::Box2f best;
  float best_turn = 0;
  const auto turned = [](const V2f& p, float turn) {
    const float c = std::cos(turn), s = std::sin(turn);
    return V2f(c * p.x - s * p.y, s * p.x + c * p.y);
  };
  for (int i = 0; i < kTurns; ++i) {
    const float turn = static_cast<float>(i) * static_cast<float>(M_PI / 2 / kTurns);
    Imath::Box2f box;
    for (const V2f& p : chart.corners) box.extendBy(turned(p, turn));
    const auto area = [](const Imath::Box2f& b) { return b.size().x * b.size().y; };
    if (i == 0 || area(box) < area(best)) {
      best = box;
      best_turn = turn;
    }
  }
  const bool upright = best.size().y > best.size().x;
  for (V2f& p : chart.corners) {
    p = turned(p, best_turn) - best.min;
    if (upright) p = V2f(best.size().y - p.y, p.x);
  }
  chart.size = best.size();
  if (upright) std::swap(chart.size.x, chart.size.y);
}

/// The triangles on the plane across their mean normal.
Chart project(const Mesh& mesh, std::vector<std::uint32_t> triangles) {
  Chart chart;
  V3f axis(0, 0, 0);
  for (const std::uint32_t t : triangles) axis += area_vector(mesh, t);
  axis.normalize();
  // The first edge is horizontal at turn 0: the rectangle of a card is found exactly.
  const std::uint32_t* corner = &mesh.indices[3 * triangles[0]];
  V3f u = mesh.positions[corner[1]] - mesh.positions[corner[0]];
  u = (u - axis * axis.dot(u)).normalized();
  const V3f v = axis.cross(u);
  const V3f origin = mesh.positions[corner[0]];
  for (const std::uint32_t t : triangles) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const V3f p = mesh.positions[mesh.indices[3 * t + k]] - origin;
      chart.corners.emplace_back(p.dot(u), p.dot(v));
    }
  }
  chart.triangles = std::move(triangles);
  fit_rectangle(chart);
  return chart;
}

/// Whether more than a few cells of a grid have their centres in several triangles, or a triangle
/// lies upside down.
bool overlaps_itself(const Chart& chart) {
  if (chart.triangles.size() == 1 || chart.size.y <= 0) return false;
  std::array<std::uint8_t, kGrid * kGrid> count{};
  const V2f cells(kGrid / chart.size.x, kGrid / chart.size.y);
  for (std::size_t t = 0; t < chart.triangles.size(); ++t) {
    const V2f* corner = &chart.corners[3 * t];
    const V2f a = corner[0] * cells, b = corner[1] * cells, c = corner[2] * cells;
    if ((b - a).cross(c - a) < 0) return true;
    const auto low = [](float x) { return std::max(0, static_cast<int>(std::floor(x - 0.5f))); };
    const auto high = [](float x) {
      return std::min(kGrid - 1, static_cast<int>(std::floor(x + 0.5f)));
    };
    for (int y = low(std::min({a.y, b.y, c.y})); y <= high(std::max({a.y, b.y, c.y})); ++y) {
      for (int x = low(std::min({a.x, b.x, c.x})); x <= high(std::max({a.x, b.x, c.x})); ++x) {
        const V2f p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        if ((b - a).cross(p - a) <= 0 || (c - b).cross(p - b) <= 0 || (a - c).cross(p - c) <= 0)
          continue;
        std::uint8_t& of_cell =
            count[static_cast<std::size_t>(y) * kGrid + static_cast<std::size_t>(x)];
        of_cell = static_cast<std::uint8_t>(std::min(2, of_cell + 1));
      }
    }
  }
  const auto covered = std::count_if(count.begin(), count.end(), [](auto n) { return n > 0; });
  const auto several = std::count(count.begin(), count.end(), 2);
  return static_cast<double>(several) > kMaxOverlap * static_cast<double>(covered);
}

}  // namespace

std::vector<Chart> make_charts(const Mesh& mesh) {
  const Neighbours neighbours(mesh);
  std::vector<bool> taken(mesh.primitive_count());
  for (std::uint32_t t = 0; t < taken.size(); ++t) taken[t] = !has_area(mesh, t);
  std::vector<Chart> charts;
  for (std::uint32_t t = 0; t < taken.size(); ++t) {
    if (taken[t]) continue;
    Chart chart = project(mesh, grow(mesh, neighbours, t, taken));
    if (!overlaps_itself(chart)) {
      charts.push_back(std::move(chart));
      continue;
    }
    for (const std::uint32_t single : chart.triangles) charts.push_back(project(mesh, {single}));
  }
  return charts;
}

std::vector<Chart> divide_chart(Chart chart, const DivisionLimits& limits) {
  const auto area = [](const Chart& c) { return c.size.x * c.size.y; };
  const bool too_long = chart.size.x > limits.length;
  std::array<Chart, 2> halves;
  for (std::size_t t = 0; t < chart.triangles.size() && (too_long || area(chart) > limits.area);
       ++t) {
    const V2f* corner = &chart.corners[3 * t];
    const bool left = corner[0].x + corner[1].x + corner[2].x < 1.5f * chart.size.x;
    Chart& half = halves[left ? 0 : 1];
    half.triangles.push_back(chart.triangles[t]);
    half.corners.insert(half.corners.end(), corner, corner + 3);
  }
  if (halves[0].triangles.empty() || halves[1].triangles.empty()) return {std::move(chart)};
  for (Chart& half : halves) fit_rectangle(half);
  if (!too_long && area(halves[0]) + area(halves[1]) > kWorthDividing * area(chart))
    return {std::move(chart)};
  std::vector<Chart> parts = divide_chart(std::move(halves[0]), limits);
  for (Chart& part : divide_chart(std::move(halves[1]), limits)) parts.push_back(std::move(part));
  return parts;
}

}  // namespace dapple
