#include "device/upload/normal_upload.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

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

/// The normals of a triangle as they are packed; zeros if it is flat.
CornerNormals normals_of(const Mesh& mesh, std::size_t triangle) {
  const auto normals = corner_normals(mesh, triangle);
  return normals ? pack_corner_normals(*normals) : CornerNormals{};
}

}  // namespace

CornerNormals pack_corner_normals(const std::array<V3f, 3>& normals) {
  const std::uint32_t a = code_of(normals[0]), b = code_of(normals[1]), c = code_of(normals[2]);
  return {{a | b << 21, b >> 11 | c << 10}};
}

std::vector<CornerNormals> pack_normals(const Scene& scene, const SceneBvh& bvh, bool keep_flat) {
  std::vector<CornerNormals> all(keep_flat ? 8 * bvh.blocks.size() : 0);
  std::atomic<bool> any = false;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (mesh.normals.empty() || mesh.has_strands()) continue;
    all.resize(8 * bvh.blocks.size(), CornerNormals{});
    // Where the object's lanes lie among those of triangles, and among all.
    const ObjectOffsets &first = bvh.objects[m], &end = bvh.objects[m + 1];
    const std::size_t lanes = 8 * std::size_t{end.block - first.block};
    const std::uint32_t* primitives = bvh.primitives.data() + first.lane();
    CornerNormals* normals = all.data() + 8 * std::size_t{first.block};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lanes, 8192), [&](const auto& range) {
      bool found = false;
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        if (primitives[i] >= mesh.primitive_count()) continue;
        normals[i] = normals_of(mesh, primitives[i]);
        found |= normals[i].words[0] != 0;
      }
      if (found) any = true;
    });
  }
  if (!any && !keep_flat) all.clear();
  return all;
}

}  // namespace dapple
