#include "bvh/opacity/wall.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "scene/disjoint_sets.hpp"

namespace dapple {
namespace {

using Imath::V3d;

/// Minimum share of interior triangles in the surfaces of a wall.
constexpr float kInteriorShare = 0.5f;
/// Minimum share of the area of triangles whose neighbours face both sides in a surface that does.
/// The corners of a room of which each wall faces as it likes are such a share.
constexpr float kMixedShare = 0.002f;
/// Below this share of the sum of its triangles' absolute values the volume of a surface says
/// nothing: each triangle is there twice, facing both sides.
constexpr double kCancelled = 1e-6;
/// Minimum share of a node's box, seen along a wall's normal, that makes the node a wall whatever
/// else is in it, such as ivy (experiment 254).
constexpr float kCovering = 0.05f;
/// Minimum length of the sum of area vectors, relative to the area. Half a sphere has 1/2, a third
/// of a tube 0.83, the walls of a room but one 0.2.
constexpr float kOneSided = 0.5f;
/// Minimum sum of the squared eigenvalues of the normals' second moments, whose trace is 1. A flat
/// surface has 1, a tube 1/2, a sphere 1/3.
constexpr float kFlat = 0.7f;
/// Maximum longest side of a node that is small inside what its surfaces enclose, in mean chords.
/// Across a twig nodes have one chord, along it more; whole nodes of the walls of a rough cave have
/// up to three (experiment 252).
constexpr float kSmallInside = 4.0f;

/// Spreads a vertex's number over all bits, so that those of different corners hardly ever add up
/// to 0 (the finalizer of MurmurHash3).
std::uint32_t hash_of(std::uint32_t vertex) {
  std::uint32_t hash = (vertex + 1) * 0x9e3779b9u;
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

/// The exclusive or of the hashes of the corners that a corner's triangles join it with. In a
/// closed ring of triangles each of them occurs twice, so the result is 0. If all triangles face
/// the same side, it is once the next corner and once the last one, so that the differences add up
/// to 0, too.
struct Ring {
  std::uint32_t ring = 0, turn = 0;

  void add(std::uint32_t next, std::uint32_t last) {
    ring ^= hash_of(next) ^ hash_of(last);
    turn += hash_of(next) - hash_of(last);
  }
  [[nodiscard]] bool is_closed() const { return ring == 0; }
  [[nodiscard]] bool faces_one_side() const { return turn == 0; }
};

/// Sums over the triangles of a connected surface.
struct SurfaceSums {
  V3d origin{0, 0, 0};            ///< a point of it, near which the sums are exact
  V3d centre{0, 0, 0};            ///< of the triangles' centres from there, times their areas
  V3d vector{0, 0, 0};            ///< of area vectors
  double area = 0, interior = 0;  ///< of all triangles, and of those inside the surface
  double product = 0;             ///< of area vectors and positions: three volumes
  double magnitude = 0;           ///< the same of triangles' absolute values
  double mixed = 0;               ///< area of triangles whose neighbours may face the other side
  double cones = 0;               ///< three times the volume between all triangles and the centre

  void add(const V3d& corner, const V3d& centre_of_triangle, const V3d& area_vector,
           bool is_interior, bool is_mixed) {
    if (area == 0) origin = corner;
    const double size = area_vector.length();
    centre += size * (centre_of_triangle - origin);
    vector += area_vector;
    area += size;
    if (is_interior) interior += size;
    if (is_mixed) mixed += size;
    const double of_triangle = area_vector.dot(corner - origin);
    product += of_triangle;
    magnitude += std::fabs(of_triangle);
  }
  /// For surfaces whose triangles face both sides, once all triangles are added.
  void add_cone(const V3d& corner, const V3d& area_vector) {
    cones += std::fabs(area_vector.dot(corner - origin - centre / area));
  }
  /// Whether product says nothing of the volume.
  [[nodiscard]] bool faces_both_sides() const {
    return mixed > double{kMixedShare} * area || std::fabs(product) < kCancelled * magnitude;
  }
  /// Seen from its centre, so that of an open surface, too, it does not depend on the origin. Where
  /// triangles face both sides it is right if all of the surface can be seen from there.
  [[nodiscard]] double volume() const {
    return faces_both_sides() ? cones / 3 : std::fabs(product - vector.dot(centre) / area) / 3;
  }
  [[nodiscard]] float mean_chord() const {
    const double chord = area > 0 ? 4 * volume() / area : 0;
    return std::max(static_cast<float>(chord), std::numeric_limits<float>::min());
  }
};

/// The chords of interior triangles. Triangles at the rim of connected surfaces most of whose area
/// is interior are so, too: beside the rim of a wall light would leak through its box as well.
/// `belongs`: whether a triangle is in a surface that has interior ones; `vertex`: a vertex at the
/// position of a triangle's corner, the same for all there; `is_mixed`: by vertex, whether not all
/// triangles of its closed ring face the same side.
template <class Belongs, class Vertex>
std::vector<float> chords_of(const OpaqueTriangles& opaque, const std::vector<bool>& interior,
                             const std::vector<bool>& is_mixed, const Belongs& belongs,
                             const Vertex& vertex) {
  DisjointSets surfaces =
      connect_triangles(opaque.positions().size(), interior.size(), belongs, vertex);
  std::vector<std::uint32_t> number(opaque.positions().size());  // by root; 0: none yet
  std::vector<SurfaceSums> sums(1);
  const auto surface_of = [&](std::size_t t) -> SurfaceSums& {
    return sums[number[surfaces.root(vertex(t, 0))]];
  };
  const auto corner = [&](std::size_t t, int k) {
    return V3d(opaque.positions()[opaque.vertex(t, k)]);
  };
  for (std::size_t t = 0; t < interior.size(); ++t) {
    if (!belongs(t)) continue;
    std::uint32_t& surface = number[surfaces.root(vertex(t, 0))];
    if (surface == 0) {
      surface = static_cast<std::uint32_t>(sums.size());
      sums.emplace_back();
    }
    bool mixed = false;
    for (int k = 0; k < 3; ++k) mixed |= is_mixed[opaque.vertex(t, k)];
    sums[surface].add(corner(t, 0), (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0,
                      V3d(opaque.area_vector(t)), interior[t], mixed);
  }
  for (std::size_t t = 0; t < interior.size(); ++t)
    if (belongs(t) && surface_of(t).faces_both_sides())
      surface_of(t).add_cone(corner(t, 0), V3d(opaque.area_vector(t)));
  std::vector<float> chords(interior.size());
  for (std::size_t t = 0; t < interior.size(); ++t) {
    if (!belongs(t)) continue;
    const SurfaceSums& surface = surface_of(t);
    if (interior[t] || surface.interior > double{kInteriorShare} * surface.area)
      chords[t] = surface.mean_chord();
  }
  return chords;
}

}  // namespace

std::vector<float> interior_triangles(const OpaqueTriangles& opaque,
                                      std::span<const std::uint32_t> welded) {
  const auto corner = [&](std::size_t t, int k) { return welded[opaque.vertex(t, k % 3)]; };
  std::vector<Ring> rings(welded.size());
  for (std::size_t t = 0; t < opaque.count(); ++t)
    for (int k = 0; k < 3; ++k) rings[corner(t, k)].add(corner(t, k + 1), corner(t, k + 2));
  std::vector<bool> interior(opaque.count()), is_near(welded.size()), is_mixed(welded.size());
  bool any = false;
  for (std::size_t t = 0; t < opaque.count(); ++t) {
    int closed = 0;
    for (int k = 0; k < 3; ++k) closed += rings[corner(t, k)].is_closed() ? 1 : 0;
    // Smaller than a step: of such triangles all corners seem to be closed.
    const bool is_small = corner(t, 0) == corner(t, 1) || corner(t, 1) == corner(t, 2) ||
                          corner(t, 2) == corner(t, 0);
    if (is_small) closed = 0;
    interior[t] = closed == 3;
    any |= interior[t];
    for (int k = 0; closed > 0 && k < 3; ++k) {
      is_near[opaque.vertex(t, k)] = true;
      const Ring& ring = rings[corner(t, k)];
      is_mixed[opaque.vertex(t, k)] = ring.is_closed() && !ring.faces_one_side();
    }
  }
  if (!any) return {};
  rings = {};
  return opaque.in_mesh(chords_of(
      opaque, interior, is_mixed,
      [&](std::size_t t) {
        return is_near[opaque.vertex(t, 0)] || is_near[opaque.vertex(t, 1)] ||
               is_near[opaque.vertex(t, 2)];
      },
      corner));
}

void WallAreas::add(const V3f& area, float opacity, float chord) {
  const float size = area.length();
  all += opacity * size;
  if (!(chord > 0.0f)) return;
  vector += area;
  interior += size;
  chords += chord * size;
}

void WallAreas::add(const WallAreas& areas) {
  vector += areas.vector;
  interior += areas.interior;
  chords += areas.chords;
  all += areas.all;
}

bool is_wall(const WallAreas& areas, const NormalMoments& normals, const Box3f& box) {
  const V3f sides = box.max - box.min;
  const V3f& v = areas.vector;
  const float projection =
      std::fabs(v.x) * sides.y * sides.z + std::fabs(v.y) * sides.z * sides.x +
      std::fabs(v.z) * sides.x * sides.y;  // of the box along the vector, times its length
  if (v.length2() > kCovering * projection && v.length() > kOneSided * areas.interior)
    return areas.interior > 0;
  if (!(areas.interior > kInteriorShare * areas.all)) return false;
  const float extent = std::max({sides.x, sides.y, sides.z});
  if (extent * areas.interior < kSmallInside * areas.chords) return true;
  if (areas.vector.length() > kOneSided * areas.interior) return true;
  const auto& m = normals.sum;
  const float trace = m[0] + m[1] + m[2];
  const float squares =
      m[0] * m[0] + m[1] * m[1] + m[2] * m[2] + 2.0f * (m[3] * m[3] + m[4] * m[4] + m[5] * m[5]);
  return squares > kFlat * trace * trace;
}

}  // namespace dapple
