// Points on the triangles of a mesh from which rays start, and how much each counts for the
// vertices around it. In: a mesh with its vertex groups. Out: samples.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bake/vertex_groups.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// Rays of one sample. So few have wide footprints, and the many samples that they leave average
/// what is near the surface: experiment 616.
inline constexpr int kRaysPerSample = 8;

/// A point of the surface in object space.
struct SurfaceSample {
  V3f position{0, 0, 0};
  V3f normal{0, 0, 0};                   ///< unit length, on the front side; shading or geometric
  V3f geometric{0, 0, 0};                ///< of smooth surfaces, as QueryPoints has it; or zero
  V3f shift{0, 0, 0};                    ///< the same
  V3f back_shift{0, 0, 0};               ///< the same, of the back
  V3f reach{0, 0, 0};                    ///< largest coordinates of its triangle, not negative
  bool is_on_plane = true;               ///< `normal`, or `geometric`, is that of a triangle
  bool front = true, back = false;       ///< sides that are traced
  bool may_be_inside = true;             ///< whether it is tested: inside_samples.hpp
  std::array<std::uint32_t, 3> place{};  ///< vertex groups, or texels, whose value it is part of
  std::array<float, 3> weight{};         ///< in these values; 0: none
  std::array<bool, 3> turned{};          ///< its front is the back of these places
};

/// Samples of each triangle and rays of each sample and side.
struct SampleCounts {
  int samples = 1;
  int rays = kRaysPerSample;
};

/// Points of a triangle that are samples in all its placements, if there are enough rays.
inline constexpr int kPointsOfPlacement = 16;

/// Divides the rays of a triangle's side over samples of kRaysPerSample rays at least: up to 64, or
/// kPointsOfPlacement for each placement if these are more; of a vertex two for each placement,
/// which tell the error. Placements have equally many samples if there are enough.
SampleCounts sample_counts(int rays, std::size_t placements, bool at_vertex = false);

/// The largest coordinates of a triangle's corners, without their signs.
V3f reach_of(const Mesh& mesh, std::size_t triangle);

/// Barycentric coordinates of point `index` of the triangular van der Corput sequence, whose first
/// 4^k points lie in different ones of 4^k equal parts (Basu and Owen, "Low Discrepancy
/// Constructions in the Triangle", 2015).
std::array<float, 3> triangle_point(std::uint32_t index);

/// Whether the triangle has a positive, finite area. Others have no samples.
bool has_area(const Mesh& mesh, std::size_t triangle);

/// A mesh as its samples need it.
struct SampledTriangles {
  const Mesh& mesh;
  const VertexGroups& groups;
  const std::vector<bool>& two_sided;  ///< by triangle
  Normals normals = Normals::shading;
};

/// Sample `index` of a triangle that has an area.
SurfaceSample sample_triangle(const SampledTriangles& of, std::size_t triangle,
                              std::uint32_t index);

/// One sample for each vertex group, with the mean normal of the triangles, or of their corners,
/// around it. Groups without such triangles have weight 0.
std::vector<SurfaceSample> sample_vertices(const SampledTriangles& of);

/// Gives a sample, whose position and geometric normal are set, the shading normal of its place in
/// the triangle; to the camera's points shading_normal.clh does the same.
void add_shading(const Mesh& mesh, std::size_t triangle, const std::array<float, 3>& barycentric,
                 SurfaceSample& sample);

}  // namespace dapple
