#include "bake/mesh_borders.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "bake/vertex_groups.hpp"
#include "bvh/opacity/welded_vertices.hpp"
#include "scene/check/invertible.hpp"

namespace dapple {
namespace {

using Imath::V3d;

/// Meshes with values, as one mesh in the world: what is placed once, or parts of a mesh.
struct JoinedMeshes {
  Mesh mesh;                                      ///< positions and indices alone
  std::vector<bool> two_sided;                    ///< by triangle
  std::vector<std::uint32_t> mesh_of, vertex_of;  ///< by vertex: in the scene
  std::vector<M44f> to_world;                     ///< by mesh of the scene
  std::size_t count = 0;                          ///< of meshes

  explicit JoinedMeshes(std::size_t meshes) : to_world(meshes) {}
};

void append(const Mesh& mesh, std::uint32_t index, const std::vector<bool>& two_sided,
            const M44f& to_world, JoinedMeshes& joined) {
  joined.to_world[index] = to_world;
  const auto first = static_cast<std::uint32_t>(joined.mesh.positions.size());
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    joined.mesh.positions.push_back(mesh.positions[v] * to_world);
    joined.mesh_of.push_back(index);
    joined.vertex_of.push_back(v);
  }
  const bool mirrored = Imath::M44d(to_world).determinant() < 0;  // turns triangles round
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const std::uint32_t* corners = &mesh.indices[3 * t];
    joined.mesh.indices.insert(
        joined.mesh.indices.end(),
        {first + corners[0], first + corners[mirrored ? 2 : 1], first + corners[mirrored ? 1 : 2]});
    joined.two_sided.push_back(!two_sided.empty() && two_sided[t]);
  }
  ++joined.count;
}

/// By mesh with values, where it is placed; empty for others.
std::vector<std::vector<M44f>> placements_of(const Scene& scene, const BakeResult& result) {
  std::vector<std::vector<M44f>> placements(scene.meshes.size());
  for (const Instance& instance : scene.instances)
    if (is_invertible(instance.to_world) && !result.meshes[instance.mesh].ao.empty())
      placements[instance.mesh].push_back(instance.to_world);
  return placements;
}

/// Meshes that are placed once; and parts of one mesh of the file, which its mesh lights divide,
/// that are placed several times, all alike. Each element is joined by itself.
std::vector<std::vector<std::uint32_t>> joined_sets(
    const Scene& scene, const std::vector<std::vector<M44f>>& placements) {
  std::vector<std::vector<std::uint32_t>> sets(1);
  std::map<std::uint32_t, std::vector<std::vector<std::uint32_t>>> parts;  // by mesh of the file
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (placements[m].size() == 1) sets[0].push_back(m);
    if (placements[m].size() < 2 || scene.meshes[m].sources.empty()) continue;
    auto& of_file = parts[scene.meshes[m].sources.front().mesh];
    const auto alike = std::find_if(of_file.begin(), of_file.end(), [&](const auto& set) {
      return placements[set.front()] == placements[m];
    });
    (alike == of_file.end() ? of_file.emplace_back() : *alike).push_back(m);
  }
  for (auto& [mesh, of_file] : parts)
    for (auto& set : of_file)
      if (set.size() > 1) sets.push_back(std::move(set));
  return sets;
}

/// Which vertices lie where another mesh has one, too.
std::vector<bool> shared_vertices(const JoinedMeshes& joined,
                                  const std::vector<std::uint32_t>& welded) {
  std::vector<bool> of_place(welded.size()), shared(welded.size());
  for (std::size_t v = 0; v < welded.size(); ++v)
    if (joined.mesh_of[v] != joined.mesh_of[welded[v]]) of_place[welded[v]] = true;
  for (std::size_t v = 0; v < welded.size(); ++v) shared[v] = of_place[welded[v]];
  return shared;
}

/// The triangles around shared vertices. All vertices at one place have the same position.
struct TrianglesAround {
  Mesh mesh;
  std::vector<bool> two_sided;
  std::vector<std::uint32_t> vertex_of;  ///< by vertex: in the joined meshes
};

TrianglesAround triangles_around(const JoinedMeshes& joined,
                                 const std::vector<std::uint32_t>& welded,
                                 const std::vector<bool>& shared) {
  TrianglesAround around;
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> number(welded.size(), kNone);
  const std::vector<std::uint32_t>& indices = joined.mesh.indices;
  for (std::size_t t = 0; t < joined.mesh.indices.size() / 3; ++t) {
    const auto corners = indices.begin() + static_cast<std::ptrdiff_t>(3 * t);
    if (std::none_of(corners, corners + 3, [&](std::uint32_t v) { return shared[v]; })) continue;
    for (auto corner = corners; corner != corners + 3; ++corner) {
      if (number[*corner] == kNone) {
        number[*corner] = static_cast<std::uint32_t>(around.vertex_of.size());
        around.vertex_of.push_back(*corner);
        around.mesh.positions.push_back(joined.mesh.positions[welded[*corner]]);
      }
      around.mesh.indices.push_back(number[*corner]);
    }
    around.mesh.materials.push_back(0);
    around.two_sided.push_back(joined.two_sided[t]);
  }
  return around;
}

V3f direction(const V3f& given, const M44f& matrix) {
  V3d turned;
  Imath::M44d(matrix).multDirMatrix(V3d(given), turned);
  return V3f(turned.normalized());
}

/// Mean over the meshes that have vertices in a group. Those of one mesh have one value.
class GroupMean {
 public:
  /// Vertices of one mesh follow one another.
  void add(std::uint32_t mesh, std::uint32_t vertex, const BakedMesh& baked, const M44f& to_world) {
    if (count_ > 0 && mesh == last_mesh_) return;
    last_mesh_ = mesh;
    ++count_;
    ao_ += baked.ao[vertex];
    if (!baked.bent.empty()) bent_ += direction(baked.bent[vertex], to_world);
    light_.resize(baked.light.size(), V3f(0, 0, 0));
    for (std::size_t l = 0; l < light_.size(); ++l) light_[l] += baked.light[l][vertex];
  }

  void store(std::uint32_t vertex, BakedMesh& baked, const M44f& to_world) const {
    if (count_ < 2) return;
    const float share = 1 / static_cast<float>(count_);
    baked.ao[vertex] = ao_ * share;
    if (!baked.bent.empty()) baked.bent[vertex] = direction(bent_, to_world.inverse());
    for (std::size_t l = 0; l < light_.size(); ++l) baked.light[l][vertex] = light_[l] * share;
  }

 private:
  std::uint32_t last_mesh_ = 0;
  int count_ = 0;
  float ao_ = 0;
  V3f bent_{0, 0, 0};  ///< in the world
  std::vector<V3f> light_;
};

void join(const JoinedMeshes& joined, BakeResult& result) {
  const std::vector<std::uint32_t> welded =
      welded_vertices(joined.mesh.positions, joined.mesh.indices);
  const std::vector<bool> shared = shared_vertices(joined, welded);
  TrianglesAround around = triangles_around(joined, welded, shared);
  const VertexGroups groups = group_vertices(around.mesh, around.two_sided);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> members;  // joined vertex, group
  for (std::size_t i = 0; i < around.vertex_of.size(); ++i)
    if (shared[around.vertex_of[i]]) members.emplace_back(around.vertex_of[i], groups.of_vertex[i]);
  std::sort(members.begin(), members.end());  // mesh after mesh
  std::vector<GroupMean> means(groups.count);
  for (const auto& [vertex, group] : members) {
    const std::uint32_t mesh = joined.mesh_of[vertex];
    means[group].add(mesh, joined.vertex_of[vertex], result.meshes[mesh], joined.to_world[mesh]);
  }
  for (const auto& [vertex, group] : members) {
    const std::uint32_t mesh = joined.mesh_of[vertex];
    means[group].store(joined.vertex_of[vertex], result.meshes[mesh], joined.to_world[mesh]);
  }
}

}  // namespace

void join_borders(const Scene& scene, const TwoSided& two_sided, BakeResult& result) {
  const std::vector<std::vector<M44f>> placements = placements_of(scene, result);
  for (const std::vector<std::uint32_t>& set : joined_sets(scene, placements)) {
    JoinedMeshes joined(scene.meshes.size());
    for (const std::uint32_t m : set)
      append(scene.meshes[m], m, two_sided.triangles(scene.meshes[m]), placements[m].front(),
             joined);
    if (joined.count > 1) join(joined, result);
  }
}

}  // namespace dapple
