#include "points/point_sources.hpp"

#include <Imath/ImathMatrix.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "dapple/error.hpp"
#include "render/queries/shared_points.hpp"

namespace dapple {

namespace {

constexpr double kMaxPoints = 1e8;

/// A point for each side of each triangle.
double side_count(const Scene& scene) {
  double sides = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (!mesh.has_strands()) sides += 2.0 * static_cast<double>(mesh.primitive_count());
  }
  return sides;
}

/// A triangle in the world.
struct PlacedTriangle {
  V3f centroid, area;  ///< `area`: along the normal, twice as long as the triangle is large
  V3f reach{0, 0, 0};  ///< the largest terms of the corners' coordinates
  PlacedTriangle(const Mesh& mesh, std::size_t triangle, const M44f& to_world) {
    V3f corner[3];
    V3d sum(0, 0, 0);
    for (std::size_t k = 0; k < 3; ++k) {
      const V3f& position = mesh.positions[mesh.indices[3 * triangle + k]];
      for (int axis = 0; axis < 3; ++axis)
        reach[axis] = std::max(reach[axis], std::fabs(position[axis]));
      corner[k] = position * to_world;
      sum += V3d(corner[k]);
    }
    centroid = V3f(sum / 3.0);
    area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    reach = reach_in_world(reach, to_world);
  }
};

}  // namespace

PointList grid_points(const std::array<double, 5>& corners, double height) {
  const auto [x0, z0, x1, z1, step] = corners;
  // A little more, so that a last point that is there but for rounding is there.
  const double columns = std::floor((x1 - x0) / step + 1e-6) + 1;
  const double rows = std::floor((z1 - z0) / step + 1e-6) + 1;
  if (!(step > 0 && columns >= 1 && rows >= 1 && columns * rows <= kMaxPoints &&
        std::isfinite(height)))
    throw Error(
        ErrorKind::usage,
        fmt::format("--grid {},{},{},{},{}: needs X0 <= X1, Z0 <= Z1 and a step above 0, and "
                    "at most {:.0e} points",
                    x0, z0, x1, z1, step, kMaxPoints));
  PointList list;
  for (double row = 0; row < rows; ++row)
    for (double column = 0; column < columns; ++column)
      list.points.emplace_back(static_cast<float>(x0 + column * step), static_cast<float>(height),
                               static_cast<float>(z0 + row * step));
  list.normals.assign(list.points.size(), V3f(0, 1, 0));
  return list;
}

PointList triangle_points(const Scene& scene) {
  const double sides = side_count(scene);
  if (!(sides <= kMaxPoints))
    throw Error(ErrorKind::usage,
                fmt::format("--per-triangle: the placed triangles have {:.3g} sides; points may be "
                            "at most {:.0e}",
                            sides, kMaxPoints));
  PointList list;
  std::vector<double> instances, materials, side_numbers, areas;
  std::size_t of_strands = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.has_strands()) {
      ++of_strands;
      continue;
    }
    // A mirrored instance reverses the winding of its triangles. The front stays the front, as glTF
    // defines it. In doubles, because a product of three small scales vanishes in floats.
    const float front = Imath::M44d(instance.to_world).determinant() < 0 ? -1.0f : 1.0f;
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      const PlacedTriangle triangle(mesh, t, instance.to_world);
      const float area = triangle.area.length();
      if (!(area > 0) || !std::isfinite(area)) continue;
      for (const float side : {front, -front}) {
        const V3f normal = triangle.area.normalized() * side;
        // Above the triangle, although points of large triangles near the origin are coarse.
        list.points.push_back(triangle.centroid +
                              normal * offset_above_plane(triangle.reach, normal));
        list.normals.push_back(normal);
        instances.push_back(static_cast<double>(i));
        materials.push_back(static_cast<double>(mesh.materials[t]));
        side_numbers.push_back(side == front ? 1 : -1);
        areas.push_back(0.5 * double{area});
      }
    }
  }
  if (of_strands > 0)
    list.notes.push_back(fmt::format("{} placed mesh{} of strands: no points on {}", of_strands,
                                     of_strands == 1 ? "" : "es", of_strands == 1 ? "it" : "them"));
  list.extra = {{"instance", std::move(instances)},
                {"material", std::move(materials)},
                {"side", std::move(side_numbers)},
                {"area", std::move(areas)}};
  return list;
}

}  // namespace dapple
