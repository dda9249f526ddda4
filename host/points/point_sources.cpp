#include "points/point_sources.hpp"

#include <Imath/ImathMatrix.h>
#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "dapple/error.hpp"

namespace dapple {

PointList grid_points(const std::array<double, 5>& corners, double height) {
  const auto [x0, z0, x1, z1, step] = corners;
  constexpr double kMaxPoints = 1e8;
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
  PointList list;
  std::vector<double> instances, materials, sides, areas;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.has_strands()) continue;
    // A mirrored instance reverses the winding of its triangles. The front stays the front, as glTF
    // defines it. In doubles, because a product of three small scales vanishes in floats.
    const float front = Imath::M44d(instance.to_world).determinant() < 0 ? -1.0f : 1.0f;
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      V3f corner[3];
      for (std::size_t k = 0; k < 3; ++k)
        corner[k] = mesh.positions[mesh.indices[3 * t + k]] * instance.to_world;
      const V3f area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
      if (!(area.length() > 0) || !std::isfinite(area.length())) continue;
      for (const float side : {front, -front}) {
        list.points.push_back((corner[0] + corner[1] + corner[2]) / 3.0f);
        list.normals.push_back(area.normalized() * side);
        instances.push_back(static_cast<double>(i));
        materials.push_back(static_cast<double>(mesh.materials[t]));
        sides.push_back(side == front ? 1 : -1);
        areas.push_back(0.5 * double{area.length()});
      }
    }
  }
  list.extra = {{"instance", std::move(instances)},
                {"material", std::move(materials)},
                {"side", std::move(sides)},
                {"area", std::move(areas)}};
  return list;
}

}  // namespace dapple
