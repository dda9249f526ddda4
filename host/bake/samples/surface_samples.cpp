#include "bake/samples/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/queries/shared_points.hpp"
#include "scene/corner_normals.hpp"

namespace dapple {
namespace {

/// Of a triangle in few placements, when the number of rays is given.
constexpr int kMaxSamples = 64;

/// How far single vertices of flat surroundings move towards the centres of their triangles.
constexpr float kFromCorner = 1e-4f;

}  // namespace

SampleCounts sample_counts(int rays, std::size_t placements, bool at_vertex) {
  const int enough = std::max(1, rays / kRaysPerSample);
  const int each = std::max(1, static_cast<int>(std::min<std::size_t>(placements, enough)));
  const int most = at_vertex ? 2 * each : std::max(kMaxSamples, kPointsOfPlacement * each);
  const int samples = std::min(enough, most) / each * each;
  return {samples, rays / samples};
}

// Each base-4 digit chooses a quarter of the triangle: the one in the middle, which is turned
// round, or the one at a corner.
std::array<float, 3> triangle_point(std::uint32_t index) {
  std::array<float, 3> point{1 / 3.0f, 1 / 3.0f, 1 / 3.0f};
  float size = 0.5f;
  for (; index > 0; index >>= 2) {
    const std::uint32_t digit = index & 3;
    if (digit == 0) {
      size = -size;
    } else {
      // The centre of the quarter at the corner, from the centre of the whole.
      for (std::uint32_t k = 0; k < 3; ++k)
        point[k] += size * ((k + 1 == digit ? 1.0f : 0.0f) - 1 / 3.0f);
    }
    size *= 0.5f;
  }
  return point;
}

bool has_area(const Mesh& mesh, std::size_t triangle) {
  const float twice_area = area_vector(mesh, triangle).length();
  return twice_area > 0 && std::isfinite(twice_area);
}

V3f reach_of(const Mesh& mesh, std::size_t triangle) {
  V3f reach(0, 0, 0);
  for (std::size_t k = 0; k < 3; ++k) {
    const V3f& corner = mesh.positions[mesh.indices[3 * triangle + k]];
    for (int axis = 0; axis < 3; ++axis)
      reach[axis] = std::max(reach[axis], std::fabs(corner[axis]));
  }
  return reach;
}

SurfaceSample sample_triangle(const SampledTriangles& of, std::size_t triangle,
                              std::uint32_t index) {
  const Mesh& mesh = of.mesh;
  const V3f cross = area_vector(mesh, triangle);
  const float twice_area = cross.length();
  const std::uint32_t* corner = &mesh.indices[3 * triangle];
  const std::array<float, 3> barycentric = triangle_point(index);
  SurfaceSample sample;
  sample.normal = cross / twice_area;
  sample.back = of.two_sided[triangle];
  sample.reach = reach_of(mesh, triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    sample.position += mesh.positions[corner[k]] * barycentric[k];
    sample.place[k] = of.groups.of_vertex[corner[k]];
    sample.weight[k] = twice_area * barycentric[k];
    sample.turned[k] = of.groups.turned[corner[k]];
  }
  if (of.normals == Normals::shading) add_shading(mesh, triangle, barycentric, sample);
  return sample;
}

void add_shading(const Mesh& mesh, std::size_t triangle, const std::array<float, 3>& barycentric,
                 SurfaceSample& sample) {
  const auto normals = corner_normals(mesh, triangle);
  if (!normals) return;
  V3f normal(0, 0, 0), front(0, 0, 0), back(0, 0, 0);
  for (std::size_t k = 0; k < 3; ++k) normal += (*normals)[k] * barycentric[k];
  for (std::size_t k = 0; k < 3; ++k) {
    const V3f away = sample.position - mesh.positions[mesh.indices[3 * triangle + k]];
    const float height = barycentric[k] * away.dot(normal - (*normals)[k]);
    front += (*normals)[k] * std::max(0.0f, height);
    back += (*normals)[k] * std::min(0.0f, height);
  }
  if (!(normal.length2() > 0)) return;
  sample.geometric = sample.normal;
  sample.normal = normal.normalized();
  sample.shift = front;
  sample.back_shift = back;
}

namespace {

/// The triangles around a vertex group.
struct Surroundings {
  float cosine = 1;     ///< the smallest one between the normals of its sample and of a triangle
  V3f inward{0, 0, 0};  ///< sum of the ways to the triangles' centres
  float triangles = 0;
  [[nodiscard]] bool are_flat() const { return cosine > 0.9999f; }
};

std::vector<Surroundings> surroundings_of(const SampledTriangles& of,
                                          const std::vector<SurfaceSample>& of_group) {
  constexpr float kSteepest = 0.02f;
  std::vector<Surroundings> all(of_group.size());
  for (std::size_t t = 0; t < of.mesh.primitive_count(); ++t) {
    if (!has_area(of.mesh, t)) continue;
    const V3f facet = area_vector(of.mesh, t).normalized();
    const std::uint32_t* corner = &of.mesh.indices[3 * t];
    const std::vector<V3f>& positions = of.mesh.positions;
    const V3f centre = (positions[corner[0]] + positions[corner[1]] + positions[corner[2]]) / 3.0f;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t group = of.groups.of_vertex[corner[k]];
      Surroundings& around = all[group];
      const float cosine = std::fabs(of_group[group].normal.normalized().dot(facet));
      around.cosine = std::min(around.cosine, std::max(cosine, kSteepest));
      around.inward += centre - positions[corner[k]];
      around.triangles += 1;
    }
  }
  return all;
}

}  // namespace

std::vector<SurfaceSample> sample_vertices(const SampledTriangles& of) {
  std::vector<SurfaceSample> of_group(of.groups.count);
  std::vector<V3f> shading(of.groups.count, V3f(0, 0, 0));
  std::vector<bool> is_smooth(of.groups.count);
  for (std::size_t t = 0; t < of.mesh.primitive_count(); ++t) {
    const V3f area = area_vector(of.mesh, t);
    const auto normals = of.normals == Normals::shading ? corner_normals(of.mesh, t) : std::nullopt;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = of.mesh.indices[3 * t + k];
      const std::uint32_t group = of.groups.of_vertex[vertex];
      SurfaceSample& sample = of_group[group];
      // The two sides of a folded sheet would cancel, if its normals do not say which is which.
      const bool first = sample.normal == V3f(0, 0, 0), is_sheet = of.two_sided[t] && !normals;
      const bool is_turned =
          is_sheet && !first ? sample.normal.dot(area) < 0 : of.groups.turned[vertex];
      const float side = is_turned ? -1.0f : 1.0f;
      sample.normal += area * side;
      shading[group] += (normals ? (*normals)[k] * area.length() : area) * side;
      is_smooth[group] = is_smooth[group] || normals;
      sample.position = of.mesh.positions[vertex];
      const V3f reach = reach_of(of.mesh, t);
      for (int axis = 0; axis < 3; ++axis)
        sample.reach[axis] = std::max(sample.reach[axis], reach[axis]);
      sample.back = sample.back || of.two_sided[t];
      sample.place[0] = group;
    }
  }
  const std::vector<Surroundings> surroundings = surroundings_of(of, of_group);
  for (std::size_t group = 0; group < of_group.size(); ++group) {
    SurfaceSample& sample = of_group[group];
    const float length = sample.normal.length();
    if (!(length > 0) || !std::isfinite(length)) continue;
    sample.normal /= length;
    const Surroundings& around = surroundings[group];
    // A corner may lie in another surface, such as a floor: its value is the limit from within.
    if (around.are_flat() && around.triangles > 0)
      sample.position += around.inward * (kFromCorner / around.triangles);
    if (around.cosine < 1)  // rays start as far above each triangle, however steep
      for (int axis = 0; axis < 3; ++axis)
        sample.reach[axis] =
            std::max(sample.reach[axis], std::fabs(sample.position[axis]) / kTermsOfReach) /
            around.cosine;
    sample.weight[0] = 1;
    sample.is_on_plane = false;
    if (!is_smooth[group] || !(shading[group].length2() > 0)) continue;
    sample.geometric = sample.normal;
    sample.normal = shading[group].normalized();
  }
  return of_group;
}

}  // namespace dapple
