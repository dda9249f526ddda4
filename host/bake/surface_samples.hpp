// Points on the triangles of a mesh from which rays start, and how much each counts for the
// vertices around it. In: a mesh with its vertex groups. Out: samples, triangle by triangle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/vertex_groups.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// A point of the surface in object space.
struct SurfaceSample {
  V3f position{0, 0, 0};
  V3f normal{0, 0, 0};  ///< unit length, on the front side
  bool two_sided = false;
  std::array<std::uint32_t, 3> group{};  ///< vertex groups that the sample counts for
  std::array<float, 3> weight{};         ///< area times barycentric coordinate; 0: does not count
};

/// Points and rays of each triangle.
struct SampleCounts {
  int points = 1;
  int rays = 16;  ///< of a point and side
};

/// Divides the rays of a triangle's side over one, three, six or twelve points, sixteen rays each
/// at least.
SampleCounts sample_counts(int rays);

/// Whether values of a triangle with this material describe both sides.
bool is_two_sided(const Material& material, BakeSides sides);

/// Appends the samples of a triangle, the points of a quadrature rule: values that are linear over
/// the triangle are averaged without an error. None for a triangle without an area.
void sample_triangle(const Mesh& mesh, std::size_t triangle, const VertexGroups& groups,
                     bool two_sided, int points, std::vector<SurfaceSample>& samples);

/// One sample for each vertex group, with the mean normal of the triangles around it. Groups
/// without such triangles are left out.
std::vector<SurfaceSample> sample_vertices(const Mesh& mesh, const VertexGroups& groups,
                                           const std::vector<bool>& two_sided_triangles);

/// Random bits from two numbers.
std::uint32_t hash_of(std::uint32_t a, std::uint32_t b);

}  // namespace dapple
