#include "rivals/surface.hpp"

#include <algorithm>
#include <cmath>

namespace dapple::bench {

Surface surface_of(const EmbreeGeometry& geometry, const RayBatch& rays, const HitBatch& hits,
                   unsigned i) {
  const std::size_t placed = geometry.flat ? 0 : hits.instance[i];
  const EmbreePlacement& placement = geometry.placements[placed];
  const EmbreeMesh& mesh = geometry.meshes[placement.mesh];
  const auto corner = [&](unsigned k) {
    return mesh.corner(hits.geometry[i], hits.primitive[i], k);
  };
  const V3f edge1 = corner(1) - corner(0), edge2 = corner(2) - corner(0);
  Surface surface{corner(0) + edge1 * hits.u[i] + edge2 * hits.v[i], edge1.cross(edge2)};
  if (!geometry.flat) {
    surface.position = surface.position * placement.to_world;
    placement.normal_matrix.multDirMatrix(V3f(surface.normal), surface.normal);
  }
  surface.normal.normalize();
  const V3f direction(rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]);
  if (surface.normal.dot(direction) > 0) surface.normal = -surface.normal;
  return surface;
}

V3f ray_start(const Surface& surface, float roundings) {
  const V3f& p = surface.position;
  const float largest = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return p + surface.normal * (largest * roundings * 0x1p-24f);
}

}  // namespace dapple::bench
