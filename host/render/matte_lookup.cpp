#include "render/matte_lookup.hpp"

#include <algorithm>

#include "dapple/shared/bvh_node.h"
#include "dapple/shared/ray.h"

namespace dapple {
namespace {

constexpr std::uint32_t kOfInstance = 0xffffffffu;

std::uint32_t object_number(int object) { return static_cast<std::uint32_t>(std::max(object, 0)); }

}  // namespace

MatteLookup::MatteLookup(const Scene& scene, const SceneBvh& bvh, Cryptomattes wanted)
    : wanted_(wanted), triangles_(8 * bvh.blocks.size()), segments_(8 * bvh.segments.size()) {
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const ObjectOffsets &first = bvh.objects[m], &end = bvh.objects[m + 1];
    Ids* ids = mesh.has_strands() ? segments_.data() + 8 * std::size_t{first.segments}
                                  : triangles_.data() + 8 * std::size_t{first.block};
    for (std::size_t lane = first.lane(); lane < end.lane(); ++lane, ++ids) {
      const std::uint32_t primitive = bvh.primitives[lane];
      if (primitive >= mesh.primitive_count()) continue;
      *ids = {mesh.objects.empty() ? kOfInstance : mesh.objects[primitive],
              mesh.materials[primitive]};
    }
  }
  for (std::size_t i = 0; i < bvh.instances.size(); ++i)
    instance_objects_.push_back(object_number(scene.instances[bvh.instances[i].source].object));
}

MatteLookup::Ids MatteLookup::at(std::uint32_t instance, std::uint32_t primitive) const {
  const bool is_segment = (primitive & DAPPLE_SEGMENTS) != 0;
  Ids ids = is_segment ? segments_[primitive & ~DAPPLE_SEGMENTS] : triangles_[primitive];
  if (ids.object == kOfInstance)
    ids.object = instance_objects_[instance == DAPPLE_WORLD ? 0 : instance];
  return {wanted_.objects ? ids.object : 0, wanted_.materials ? ids.material : 0};
}

}  // namespace dapple
