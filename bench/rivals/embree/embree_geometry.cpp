#include "rivals/embree/embree_geometry.hpp"

namespace dapple::bench {
namespace {

EmbreeMesh sorted_by_opacity(const Scene& scene, const Mesh& mesh) {
  EmbreeMesh sorted;
  sorted.positions = mesh.positions;
  sorted.positions.emplace_back(0.0f);
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const std::optional<float> constant = constant_opacity(scene, mesh, t);
    if (constant && *constant <= 0.0f) continue;
    const bool opaque = constant && *constant >= 1.0f;
    if (!opaque) sorted.opacity.append(scene, mesh, t);
    auto& indices = sorted.triangles[opaque ? kOpaqueGeometry : kTranslucentGeometry];
    for (std::size_t k = 0; k < 3; ++k) indices.push_back(mesh.indices[3 * t + k]);
  }
  return sorted;
}

/// Embree joins segments whose first vertices follow each other.
EmbreeMesh curves_by_opacity(const Scene& scene, const Mesh& mesh) {
  EmbreeMesh sorted;
  sorted.opacity.set_strands();
  const auto append = [&](std::uint32_t vertex) {
    const V3f& p = mesh.positions[vertex];
    sorted.curve_vertices.insert(sorted.curve_vertices.end(), {p.x, p.y, p.z, mesh.radii[vertex]});
  };
  const std::uint32_t* before = nullptr;  // vertices of the segment that was appended last
  for (std::size_t s = 0; s < mesh.primitive_count(); ++s) {
    const float opacity = segment_opacity(scene, mesh, s);
    if (opacity <= 0.0f) continue;
    if (opacity < 1.0f) sorted.opacity.append(opacity);
    const std::uint32_t* at = &mesh.indices[2 * s];
    if (!before || before[1] != at[0]) append(at[0]);
    before = at;
    const auto last = static_cast<unsigned>(sorted.curve_vertices.size() / 4 - 1);
    sorted.curves[opacity >= 1.0f ? kOpaqueGeometry : kTranslucentGeometry].push_back(last);
    append(at[1]);
  }
  return sorted;
}

EmbreePlacement placed(const Instance& instance) {
  EmbreePlacement placement{instance.mesh, instance.to_world, instance.to_world};
  placement.normal_matrix[3][0] = placement.normal_matrix[3][1] = placement.normal_matrix[3][2] = 0;
  placement.normal_matrix = placement.normal_matrix.inverse().transposed();
  return placement;
}

}  // namespace

EmbreeGeometry::EmbreeGeometry(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    const EmbreeMesh& sorted = meshes.emplace_back(
        mesh.has_strands() ? curves_by_opacity(scene, mesh) : sorted_by_opacity(scene, mesh));
    bytes += sorted.curve_vertices.size() * sizeof(float);
    for (const auto& curves : sorted.curves) {
      triangles += curves.size();
      bytes += curves.size() * sizeof(unsigned);
    }
    bytes += sorted.positions.size() * sizeof(V3f) + sorted.opacity.bytes();
    for (const auto& indices : sorted.triangles) {
      triangles += indices.size() / 3;
      bytes += indices.size() * sizeof(unsigned);
    }
  }
  for (const Instance& instance : scene.instances) placements.push_back(placed(instance));
  flat = placements.size() == 1 && placements[0].to_world == M44f();
}

}  // namespace dapple::bench
