#include "render/frame_match.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace dapple {
namespace {

std::size_t corners_of(const Mesh& mesh) { return mesh.has_strands() ? 2 : 3; }

std::string object_name(const Scene& scene, std::int64_t object) {
  return object < 0 ? std::string() : scene.objects[static_cast<std::size_t>(object)];
}

/// Parts of a scene with the names of their objects.
struct NamedPart {
  MatchedPart part;
  std::string object;
  bool merged = false;  ///< in a mesh of several objects, in world space
};

void add_runs(const Scene& scene, std::uint32_t m, std::vector<NamedPart>& parts) {
  const std::vector<std::uint32_t>& objects = scene.meshes[m].objects;
  for (std::uint32_t first = 0, end = 0; first < objects.size(); first = end) {
    while (end < objects.size() && objects[end] == objects[first]) ++end;
    parts.push_back({{m, first, end - first}, object_name(scene, objects[first]), true});
  }
  const auto named = static_cast<std::uint32_t>(objects.size());
  const auto all = static_cast<std::uint32_t>(scene.meshes[m].primitive_count());
  if (named < all) parts.push_back({{m, named, all - named}, "", true});
}

/// A mesh that is placed as a whole has the name of its first placement.
std::vector<NamedPart> parts_of(const Scene& scene) {
  std::vector<int> placed(scene.meshes.size(), -1);
  for (const Instance& instance : scene.instances)
    if (placed[instance.mesh] < 0) placed[instance.mesh] = instance.object;
  std::vector<NamedPart> parts;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (mesh.objects.empty()) {
      const auto count = static_cast<std::uint32_t>(mesh.primitive_count());
      parts.push_back({{m, 0, count}, object_name(scene, placed[m]), false});
    } else {
      add_runs(scene, m, parts);
    }
  }
  return parts;
}

/// Pairs the elements of both ranges that have the same key, in order, where they are as many.
template <class KeyOf, class KeyOfNext, class Pair>
void pair_by_key(std::size_t now, std::size_t next, const KeyOf& key_of,
                 const KeyOfNext& key_of_next, const Pair& pair) {
  std::map<decltype(key_of(0)), std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> both;
  for (std::size_t i = 0; i < now; ++i) both[key_of(i)].first.push_back(i);
  for (std::size_t i = 0; i < next; ++i) both[key_of_next(i)].second.push_back(i);
  for (const auto& [key, found] : both) {
    const auto& [of_now, of_next] = found;
    if (of_now.size() != of_next.size()) continue;
    for (std::size_t i = 0; i < of_now.size(); ++i) pair(of_now[i], of_next[i]);
  }
}

/// Fills in the counterpart of a part, if its primitives join its vertices alike.
void match(const Scene& now, const Scene& next, const MatchedPart& to, MatchedPart& part) {
  const Mesh &mesh = now.meshes[part.mesh], &moved = next.meshes[to.mesh];
  if (part.count != to.count || part.count == 0 || mesh.has_strands() != moved.has_strands())
    return;
  const std::size_t corners = corners_of(mesh), indices = corners * part.count;
  const std::uint32_t* index = &mesh.indices[corners * part.first];
  const std::uint32_t* next_index = &moved.indices[corners * to.first];
  part.vertex_shift = std::int64_t{next_index[0]} - std::int64_t{index[0]};
  part.next_mesh = to.mesh;
  for (std::size_t i = 0; i < indices; ++i) {
    if (std::int64_t{index[i]} + part.vertex_shift != std::int64_t{next_index[i]}) return;
    part.deforms |= mesh.positions[index[i]] != moved.positions[next_index[i]];
  }
  part.is_there = true;
}

}  // namespace

FrameMatch::FrameMatch(const Scene& now, const Scene& next) : instances(now.instances.size(), -1) {
  std::vector<NamedPart> of_now = parts_of(now);
  const std::vector<NamedPart> of_next = parts_of(next);
  const auto part_key = [](const NamedPart& part) { return std::pair(part.object, part.merged); };
  pair_by_key(
      of_now.size(), of_next.size(), [&](std::size_t i) { return part_key(of_now[i]); },
      [&](std::size_t i) { return part_key(of_next[i]); },
      [&](std::size_t i, std::size_t k) { match(now, next, of_next[k].part, of_now[i].part); });
  for (const NamedPart& named : of_now) parts.push_back(named.part);
  pair_by_key(
      now.instances.size(), next.instances.size(),
      [&](std::size_t i) { return object_name(now, now.instances[i].object); },
      [&](std::size_t i) { return object_name(next, next.instances[i].object); },
      [&](std::size_t i, std::size_t k) { instances[i] = static_cast<int>(k); });
}

}  // namespace dapple
