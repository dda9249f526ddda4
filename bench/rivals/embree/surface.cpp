#include "rivals/embree/surface.hpp"

#include <algorithm>
#include <cmath>

namespace dapple::bench {

namespace {

/// The point of the segment's surface that is closest to `hit`, in object space.
Surface point_on_segment(const EmbreeMesh& mesh, unsigned geometry, unsigned segment, float u,
                         const V3f& hit) {
  const float* a = mesh.curve_end(geometry, segment, 0);
  const float* b = mesh.curve_end(geometry, segment, 1);
  const V3f begin(a[0], a[1], a[2]), axis = V3f(b[0], b[1], b[2]) - begin;
  const V3f middle = begin + axis * u;
  const V3f normal = (hit - middle).normalized();
  return {middle + normal * (a[3] + u * (b[3] - a[3])), normal};
}

Surface point_on_triangle(const EmbreeMesh& mesh, const HitBatch& hits, unsigned i) {
  const auto corner = [&](unsigned k) {
    return mesh.corner(hits.geometry[i], hits.primitive[i], k);
  };
  const V3f edge1 = corner(1) - corner(0), edge2 = corner(2) - corner(0);
  return {corner(0) + edge1 * hits.u[i] + edge2 * hits.v[i], edge1.cross(edge2)};
}

}  // namespace

Surface surface_of(const EmbreeGeometry& geometry, const RayBatch& rays, const HitBatch& hits,
                   unsigned i) {
  const std::size_t placed = geometry.flat ? 0 : hits.instance[i];
  const EmbreePlacement& placement = geometry.placements[placed];
  const EmbreeMesh& mesh = geometry.meshes[placement.mesh];
  const V3f direction(rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]);
  Surface surface;
  if (mesh.has_strands()) {
    const V3f origin(rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]);
    const V3f hit = origin + direction * hits.t[i];
    surface = point_on_segment(mesh, hits.geometry[i], hits.primitive[i], hits.u[i],
                               geometry.flat ? hit : hit * placement.to_world.inverse());
  } else {
    surface = point_on_triangle(mesh, hits, i);
  }
  if (!geometry.flat) {
    surface.position = surface.position * placement.to_world;
    placement.normal_matrix.multDirMatrix(V3f(surface.normal), surface.normal);
  }
  surface.normal.normalize();
  if (surface.normal.dot(direction) > 0) surface.normal = -surface.normal;
  return surface;
}

V3f ray_start(const Surface& surface, float roundings) {
  const V3f& p = surface.position;
  const float largest = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return p + surface.normal * (largest * roundings * 0x1p-24f);
}

}  // namespace dapple::bench
