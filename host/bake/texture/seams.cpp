#include "bake/texture/seams.hpp"

#include <algorithm>
#include <cmath>

#include "bake/samples/surface_samples.hpp"
#include "bake/vertex_groups.hpp"

namespace dapple {
namespace {

/// Cosine of the angle between the triangles of an edge from which on it is hard.
constexpr float kHardCosine = 0.3f;

constexpr int kSweeps = 32;
constexpr float kPointsPerTexel = 2;

/// An edge of a triangle, from corner `k` on.
struct TriangleEdge {
  std::uint64_t groups;  ///< of its vertices, the smaller one in the upper half
  std::uint32_t triangle;
  std::uint8_t k;
  bool swapped;  ///< its first vertex is of the larger group
  bool operator<(const TriangleEdge& other) const {
    return groups != other.groups ? groups < other.groups : triangle < other.triangle;
  }
};

std::vector<TriangleEdge> sorted_edges(const Mesh& mesh) {
  const VertexGroups groups = group_vertices(mesh);
  std::vector<TriangleEdge> edges;
  edges.reserve(mesh.indices.size());
  for (std::uint32_t t = 0; t < mesh.primitive_count(); ++t) {
    if (!has_area(mesh, t)) continue;  // its neighbours are those of each other
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint64_t a = groups.of_vertex[mesh.indices[3 * t + k]];
      const std::uint64_t b = groups.of_vertex[mesh.indices[3 * t + (k + 1u) % 3]];
      if (a != b) edges.push_back({std::min(a, b) << 32 | std::max(a, b), t, k, a > b});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// The ends of an edge in the texture, the one of the smaller vertex group first.
std::array<V2f, 2> ends_of(const TriangleEdge& edge, std::span<const V2f> corners) {
  const V2f &first = corners[3 * edge.triangle + edge.k],
            &second = corners[3 * edge.triangle + (edge.k + 1u) % 3];
  if (edge.swapped) return {second, first};
  return {first, second};
}

Lookup lookup_at(const V2f& uv, std::uint32_t size) {
  const float x = uv.x * static_cast<float>(size) - 0.5f,
              y = uv.y * static_cast<float>(size) - 0.5f;
  const float a = x - std::floor(x), b = y - std::floor(y);
  const auto texel = [&](float u, float v) {
    const auto clamped = [&](float c) {
      return static_cast<std::uint32_t>(std::clamp(c, 0.0f, static_cast<float>(size - 1)));
    };
    return clamped(std::floor(v)) * size + clamped(std::floor(u));
  };
  return {{texel(x, y), texel(x + 1, y), texel(x, y + 1), texel(x + 1, y + 1)},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
}

template <class Value>
void join(std::span<const SeamPoint> points, std::vector<Value>& texels) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [a, b] : points) {
      Value difference(0);
      float squares = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        difference += texels[a.texel[i]] * a.weight[i] - texels[b.texel[i]] * b.weight[i];
        squares += a.weight[i] * a.weight[i] + b.weight[i] * b.weight[i];
      }
      for (std::size_t i = 0; i < 4; ++i) {
        texels[a.texel[i]] -= difference * (a.weight[i] / squares);
        texels[b.texel[i]] += difference * (b.weight[i] / squares);
      }
    }
  }
}

}  // namespace

std::vector<SeamPoint> seam_points(const Mesh& mesh, std::span<const V2f> corners,
                                   std::uint32_t size) {
  std::vector<SeamPoint> points;
  const std::vector<TriangleEdge> edges = sorted_edges(mesh);
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].groups == edges[begin].groups) ++end;
    if (end - begin != 2) continue;
    const TriangleEdge &one = edges[begin], &other = edges[begin + 1];
    const auto [a0, a1] = ends_of(one, corners);
    const auto [b0, b1] = ends_of(other, corners);
    if (a0 == b0 && a1 == b1) continue;
    const V3f normal = area_vector(mesh, one.triangle).normalized();
    if (normal.dot(area_vector(mesh, other.triangle).normalized()) < kHardCosine) continue;
    const float texels =
        std::max((a1 - a0).length(), (b1 - b0).length()) * static_cast<float>(size);
    const int count = std::max(2, static_cast<int>(std::ceil(texels * kPointsPerTexel)));
    for (int i = 0; i < count; ++i) {
      const float t = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
      points.push_back({lookup_at(a0 + (a1 - a0) * t, size), lookup_at(b0 + (b1 - b0) * t, size)});
    }
  }
  return points;
}

void join_seams(std::span<const SeamPoint> points, std::vector<float>& texels) {
  join(points, texels);
}

void join_seams(std::span<const SeamPoint> points, std::vector<V3f>& texels) {
  join(points, texels);
}

}  // namespace dapple
