#include "device/upload/normal_upload.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "scene/corner_normals.hpp"

namespace dapple {
namespace {

std::uint32_t code_of(const V3f& normal) {
  float x = 0, y = 0;
  octahedral_point(&normal.x, &x, &y);
  const auto steps = [](float coordinate) {
    constexpr float kLast = DAPPLE_NORMAL_SIDE - 1;
    return static_cast<std::uint32_t>(
        std::lround(std::clamp(0.5f * (coordinate + 1) * kLast, 0.0f, kLast)));
  };
  return 1 + steps(x) + DAPPLE_NORMAL_SIDE * steps(y);
}

/// Which triangles of a mesh have corner_normals(), a byte each. Found in the order of the mesh,
/// which its vertices mostly follow in memory; the lanes of blocks do not.
std::vector<std::uint8_t> smooth_triangles(const Mesh& mesh) {
  std::vector<std::uint8_t> smooth(mesh.primitive_count());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, smooth.size(), 8192),
                    [&](const auto& range) {
                      for (std::size_t t = range.begin(); t < range.end(); ++t)
                        smooth[t] = corner_normals(mesh, t) ? 1 : 0;
                    });
  return smooth;
}

/// The triangles of a mesh by the lanes of its blocks.
struct MeshLanes {
  const Mesh& mesh;
  std::vector<std::uint8_t> smooth;  ///< smooth_triangles()
  const std::uint32_t* primitives;   ///< of the mesh's first lane
  std::size_t first_block, end_block;

  /// The triangle in a lane, if it is smooth.
  [[nodiscard]] std::optional<std::uint32_t> smooth_triangle(std::size_t block,
                                                             std::size_t lane) const {
    const std::uint32_t triangle = primitives[8 * (block - first_block) + lane];
    if (triangle >= smooth.size() || !smooth[triangle]) return {};
    return triangle;
  }
  [[nodiscard]] bool is_smooth(std::size_t block) const {
    for (std::size_t lane = 0; lane < 8; ++lane)
      if (smooth_triangle(block, lane)) return true;
    return false;
  }
};

/// The meshes that have normals.
std::vector<MeshLanes> meshes_with_normals(const Scene& scene, const SceneBvh& bvh) {
  std::vector<MeshLanes> meshes;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (mesh.normals.empty() || mesh.has_strands()) continue;
    meshes.push_back({mesh, smooth_triangles(mesh), bvh.primitives.data() + bvh.objects[m].lane(),
                      bvh.objects[m].block, bvh.objects[m + 1].block});
  }
  return meshes;
}

template <class Body>
void for_each_block(const std::vector<MeshLanes>& meshes, const Body& body) {
  for (const MeshLanes& mesh : meshes) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(mesh.first_block, mesh.end_block, 1024),
                      [&](const auto& range) {
                        for (std::size_t block = range.begin(); block < range.end(); ++block)
                          body(mesh, block);
                      });
  }
}

}  // namespace

CornerNormals pack_corner_normals(const std::array<V3f, 3>& normals) {
  const std::uint32_t a = code_of(normals[0]), b = code_of(normals[1]), c = code_of(normals[2]);
  return {{a | b << 21, b >> 11 | c << 10}};
}

std::vector<CornerNormals> pack_normals(const Scene& scene, const SceneBvh& bvh, bool keep_flat) {
  const std::vector<MeshLanes> meshes = meshes_with_normals(scene, bvh);
  std::vector<std::uint32_t> group_of(bvh.blocks.size(), 0);
  for_each_block(meshes, [&](const MeshLanes& lanes, std::size_t block) {
    group_of[block] = lanes.is_smooth(block) ? 1 : 0;
  });
  // The table of groups takes the first groups.
  const std::size_t table = (group_of.size() + 15) / 16;
  std::size_t groups = table;
  for (std::uint32_t& group : group_of)
    if (group) group = static_cast<std::uint32_t>(groups++);
  if (groups == table && !keep_flat) return {};
  if (group_of.empty()) return std::vector<CornerNormals>(DAPPLE_NORMAL_GROUP);  // strands alone
  std::vector<CornerNormals> all(DAPPLE_NORMAL_GROUP * groups, CornerNormals{});
  std::memcpy(all.data(), group_of.data(), group_of.size() * sizeof(group_of[0]));
  for_each_block(meshes, [&](const MeshLanes& lanes, std::size_t block) {
    for (std::size_t lane = 0; group_of[block] && lane < DAPPLE_NORMAL_GROUP; ++lane) {
      const auto triangle = lanes.smooth_triangle(block, lane);
      if (!triangle) continue;
      all[DAPPLE_NORMAL_GROUP * std::size_t{group_of[block]} + lane] =
          pack_corner_normals(*corner_normals(lanes.mesh, *triangle));
    }
  });
  return all;
}

}  // namespace dapple
