#include "scene/corner_normals.hpp"

namespace dapple {
namespace {

/// Cosine of the angle up to which a normal counts as the face's: 0.1 degrees.
constexpr double kFlat = 1 - 1.5e-6;

/// Whether all normals are the face's or all are its opposite, without a root. `face`: of any
/// length. A normal of length 0 is left to the caller.
bool all_along(const V3d& face, const std::array<V3d, 3>& normals) {
  const double limit = kFlat * kFlat * face.length2();
  const bool along = normals[0].dot(face) > 0;
  for (const V3d& normal : normals) {
    const double cosine = normal.dot(face);  // times both lengths
    if ((cosine > 0) != along || !(cosine * cosine > limit * normal.length2())) return false;
  }
  return true;
}

}  // namespace

std::optional<std::array<V3f, 3>> corner_normals(const Mesh& mesh, std::size_t triangle) {
  if (mesh.normals.empty()) return {};
  const std::uint32_t* corner = &mesh.indices[3 * triangle];
  std::array<V3d, 3> normals;
  for (std::size_t k = 0; k < 3; ++k) normals[k] = V3d(mesh.normals[corner[k]]);
  const V3d zero(0.0);
  if (normals[0] == zero && normals[1] == zero && normals[2] == zero) return {};
  const V3d a(mesh.positions[corner[0]]), b(mesh.positions[corner[1]]),
      c(mesh.positions[corner[2]]);
  const V3d area = (b - a).cross(c - a);
  if (all_along(area, normals)) return {};
  const V3d face = area.normalized();
  V3d sum(0.0);
  for (V3d& normal : normals) {
    normal = normal.length2() > 0 ? normal.normalized() : face;
    sum += normal;
  }
  if (!(sum.length2() > 0)) return {};  // or not a number
  const double side = sum.dot(face) < 0 ? -1 : 1;
  std::array<V3f, 3> turned;
  bool is_flat = true;
  for (std::size_t k = 0; k < 3; ++k) {
    is_flat &= side * normals[k].dot(face) >= kFlat;
    turned[k] = V3f(normals[k] * side);
  }
  if (is_flat) return {};
  return turned;
}

bool is_smooth(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.normals.empty() || mesh.has_strands()) continue;
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t)
      if (corner_normals(mesh, t)) return true;
  }
  return false;
}

}  // namespace dapple
