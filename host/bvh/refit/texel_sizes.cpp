#include "bvh/refit/texel_sizes.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>

#include "bvh/opacity/triangle_opacity.hpp"
#include "bvh/storage/textured_triangle.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

bool set_texel_sizes(const Scene& scene, const Mesh& mesh, std::span<const TriangleBlock> blocks,
                     std::span<const std::uint32_t> primitives,
                     std::span<TexturedTriangle> textured) {
  std::atomic<bool> any = false;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.size(), 512), [&](const auto& range) {
    bool changed = false;
    for (std::size_t lane = 8 * range.begin(); lane < 8 * range.end(); ++lane) {
      const float opacity = blocks[lane / 8].opacity[lane % 8];
      if (primitives[lane] == kNoPrimitive || !(opacity < 0.0f)) continue;
      TexturedTriangle& triangle = textured[static_cast<std::size_t>(-opacity - 1.0f)];
      const uint before = triangle.corner[1][1];
      set_texel_size(triangle, texel_size(scene, mesh, primitives[lane]));
      changed |= triangle.corner[1][1] != before;
    }
    if (changed) any = true;
  });
  return any;
}

}  // namespace dapple
