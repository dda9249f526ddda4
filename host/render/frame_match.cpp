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

using Runs = std::vector<MatchedPart>;

/// Runs of primitives of one object each, by its name; "" are those without one.
void add_runs(const Scene& scene, std::uint32_t m, std::map<std::string, Runs>& runs) {
  const std::vector<std::uint32_t>& objects = scene.meshes[m].objects;
  for (std::uint32_t first = 0, end = 0; first < objects.size(); first = end) {
    while (end < objects.size() && objects[end] == objects[first]) ++end;
    runs[object_name(scene, objects[first])].push_back({m, first, end - first});
  }
  const auto named = static_cast<std::uint32_t>(objects.size());
  const auto all = static_cast<std::uint32_t>(scene.meshes[m].primitive_count());
  if (named < all) runs[""].push_back({m, named, all - named});
}

/// Of meshes whose primitives have objects of their own.
std::map<std::string, Runs> runs_of(const Scene& scene) {
  std::map<std::string, Runs> runs;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    if (!scene.meshes[m].objects.empty()) add_runs(scene, m, runs);
  return runs;
}

/// All primitives of a mesh that is placed as a whole.
MatchedPart whole_mesh(const Scene& scene, std::uint32_t m) {
  return {m, 0, static_cast<std::uint32_t>(scene.meshes[m].primitive_count())};
}

/// For each mesh of `now` that is placed as a whole, that of `next` which the first placement that
/// both frames have is of, else -1. `instances`: as FrameMatch::instances.
std::vector<std::int64_t> meshes_of_placements(const Scene& now, const Scene& next,
                                               const std::vector<int>& instances) {
  std::vector<std::int64_t> meshes(now.meshes.size(), -1);
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (instances[i] < 0) continue;
    const std::uint32_t mesh = next.instances[static_cast<std::size_t>(instances[i])].mesh;
    std::int64_t& found = meshes[now.instances[i].mesh];
    if (found < 0 && next.meshes[mesh].objects.empty()) found = mesh;
  }
  return meshes;
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

std::uint64_t count_of(const Runs& runs) {
  std::uint64_t count = 0;
  for (const MatchedPart& run : runs) count += run.count;
  return count;
}

/// Appends the runs of an object and their counterparts, in order. Where something between two runs
/// is not in the other frame, these are one run there: both are cut at the ends of both.
void match_runs(const Scene& now, const Scene& next, const Runs& runs, const Runs& next_runs,
                Runs& parts) {
  if (count_of(runs) != count_of(next_runs)) {
    parts.insert(parts.end(), runs.begin(), runs.end());
    return;
  }
  auto to = next_runs.begin();
  std::uint32_t taken = 0;  // of *to
  for (MatchedPart run : runs) {
    while (run.count > 0) {
      const std::uint32_t count = std::min(run.count, to->count - taken);
      MatchedPart part{run.mesh, run.first, count};
      match(now, next, {to->mesh, to->first + taken, count}, part);
      parts.push_back(part);
      run.first += count;
      run.count -= count;
      taken += count;
      if (taken == to->count) ++to, taken = 0;
    }
  }
}

}  // namespace

FrameMatch::FrameMatch(const Scene& now, const Scene& next) : instances(now.instances.size(), -1) {
  pair_by_key(
      now.instances.size(), next.instances.size(),
      [&](std::size_t i) { return object_name(now, now.instances[i].object); },
      [&](std::size_t i) { return object_name(next, next.instances[i].object); },
      [&](std::size_t i, std::size_t k) { instances[i] = static_cast<int>(k); });
  const std::map<std::string, Runs> next_runs = runs_of(next);
  for (const auto& [object, runs] : runs_of(now)) {
    const auto found = next_runs.find(object);
    match_runs(now, next, runs, found == next_runs.end() ? Runs() : found->second, parts);
  }
  const std::vector<std::int64_t> meshes = meshes_of_placements(now, next, instances);
  for (std::uint32_t m = 0; m < meshes.size(); ++m) {
    if (!now.meshes[m].objects.empty()) continue;
    parts.push_back(whole_mesh(now, m));
    if (meshes[m] >= 0)
      match(now, next, whole_mesh(next, static_cast<std::uint32_t>(meshes[m])), parts.back());
  }
  std::sort(parts.begin(), parts.end(), [](const MatchedPart& a, const MatchedPart& b) {
    return std::pair(a.mesh, a.first) < std::pair(b.mesh, b.first);
  });
}

}  // namespace dapple
