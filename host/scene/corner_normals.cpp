#include "scene/corner_normals.hpp"

namespace dapple {
namespace {

/// Cosine of the angle up to which a normal counts as the face's: 0.1 degrees.
constexpr double kFlat = 1 - 1.5e-6;

}  // namespace

std::optional<std::array<V3f, 3>> corner_normals(const Mesh& mesh, std::size_t triangle) {
  if (mesh.normals.empty()) return {};
  const std::uint32_t* corner = &mesh.indices[3 * triangle];
  const V3d a(mesh.positions[corner[0]]), b(mesh.positions[corner[1]]),
      c(mesh.positions[corner[2]]);
  const V3d face = (b - a).cross(c - a).normalized();
  std::array<V3d, 3> normals;
  V3d sum(0.0);
  bool is_flat = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const V3d given(mesh.normals[corner[k]]);
    normals[k] = given.length2() > 0 ? given.normalized() : face;
    sum += normals[k];
  }
  if (!(sum.length2() > 0)) return {};  // or not a number
  const double side = sum.dot(face) < 0 ? -1 : 1;
  std::array<V3f, 3> turned;
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
