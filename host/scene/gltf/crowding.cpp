// Counts instances with equal mesh and matrix by their hash: see crowding.hpp.
#include "scene/gltf/crowding.hpp"

#include <bit>
#include <cstdint>
#include <unordered_map>

#include "scene/check/invertible.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

constexpr std::uint32_t kMaxAtOnePosition = 1000;

/// FNV-1a over 32-bit words. Among some million different instances, equal hashes are unlikely, and
/// only a thousand of them would cause a wrong error.
std::uint64_t hash(const Instance& instance) {
  std::uint64_t value = 0xcbf29ce484222325u;
  const auto mix = [&](std::uint32_t word) { value = (value ^ word) * 0x100000001b3u; };
  mix(instance.mesh);
  for (const auto& row : instance.to_world.x) {
    for (const float entry : row) mix(std::bit_cast<std::uint32_t>(entry));
  }
  return value;
}

}  // namespace

void check_crowding(const Scene& scene) {
  if (scene.instances.size() <= kMaxAtOnePosition) return;
  std::unordered_map<std::uint64_t, std::uint32_t> counts;
  counts.reserve(scene.instances.size());
  for (const Instance& instance : scene.instances) {
    if (!is_invertible(instance.to_world)) continue;  // scaled to nothing: not placed
    if (++counts[hash(instance)] <= kMaxAtOnePosition) continue;
    fail(scene.source, "mesh \"{}\" has more than {} instances at one position",
         excerpt(scene.meshes[instance.mesh].name), grouped(kMaxAtOnePosition));
  }
}

}  // namespace dapple::gltf
