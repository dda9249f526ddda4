#include "bake/vertex_bake.hpp"

#include <algorithm>

#include "bake/hidden_vertices.hpp"
#include "bake/sample_rounds.hpp"

namespace dapple {
namespace {

/// Random bits of the first sample's place in a triangle, two for each halving of the sides.
constexpr std::uint32_t kMaxShift = 0xffff;

/// Triangles, or vertex groups, of a mesh, each with a sequence of samples.
class SampledMesh : public SampledSurface {
 public:
  SampledMesh(const Mesh& mesh, const VertexGroups& groups, const std::vector<bool>& two_sided,
              bool at_vertices, std::uint32_t hash)
      : mesh_(mesh), groups_(groups), two_sided_(two_sided), hash_(hash) {
    if (at_vertices) at_vertices_ = sample_vertices(mesh, groups, two_sided);
    is_at_vertices_ = at_vertices;
  }

  [[nodiscard]] std::size_t size() const override {
    return is_at_vertices_ ? at_vertices_.size() : mesh_.primitive_count();
  }

  [[nodiscard]] bool can_be_sampled(std::size_t i) const override {
    return is_at_vertices_ ? at_vertices_[i].weight[0] > 0 : has_area(mesh_, i);
  }

  [[nodiscard]] SurfaceSample sample(std::size_t i, std::uint32_t index) const override {
    if (is_at_vertices_) return at_vertices_[i];
    // A digital shift, which keeps the parts of the sequence: without it the first sample of all
    // triangles would be their centre, where cards often cross.
    const std::uint32_t shift = hash_of(hash_, static_cast<std::uint32_t>(i)) & kMaxShift;
    return sample_triangle(mesh_, i, groups_, two_sided_[i], index ^ shift);
  }

  [[nodiscard]] std::array<std::uint32_t, 3> places(std::size_t i) const override {
    if (is_at_vertices_) {
      const auto group = static_cast<std::uint32_t>(i);
      return {group, group, group};
    }
    const std::uint32_t* corner = &mesh_.indices[3 * i];
    return {groups_.of_vertex[corner[0]], groups_.of_vertex[corner[1]],
            groups_.of_vertex[corner[2]]};
  }

 private:
  const Mesh& mesh_;
  const VertexGroups& groups_;
  const std::vector<bool>& two_sided_;
  std::uint32_t hash_;
  std::vector<SurfaceSample> at_vertices_;
  bool is_at_vertices_ = false;
};

BakedMesh vertex_values(const Mesh& mesh, const VertexGroups& groups, const ValueSums& sums,
                        bool bent, std::size_t& hidden) {
  std::vector<PlaceValue> values = sums.values();
  const auto hidden_groups =
      std::count_if(values.begin(), values.end(), [](const PlaceValue& v) { return !v.known; });
  if (hidden_groups > 0) spread_to_hidden(mesh, groups, values);
  hidden += static_cast<std::size_t>(hidden_groups);
  BakedMesh baked;
  baked.ao.resize(mesh.positions.size());
  if (bent) baked.bent.resize(mesh.positions.size());
  for (std::size_t vertex = 0; vertex < baked.ao.size(); ++vertex) {
    const PlaceValue& value = values[groups.of_vertex[vertex]];
    baked.ao[vertex] = value.ao;
    if (bent) baked.bent[vertex] = value.bent;
  }
  return baked;
}

}  // namespace

std::vector<bool> two_sided_triangles(const Scene& scene, const Mesh& mesh, BakeSides sides) {
  std::vector<bool> two_sided(mesh.primitive_count());
  for (std::size_t t = 0; t < two_sided.size(); ++t)
    two_sided[t] = is_two_sided(scene.materials[mesh.materials[t]], sides);
  return two_sided;
}

SmallParts small_parts(const Mesh& mesh, const VertexGroups& groups) {
  SmallParts parts{connected_parts(mesh, groups), 0};
  std::vector<std::uint32_t> size(groups.count), number(groups.count, SmallParts::kLarge);
  for (const std::uint32_t part : parts.of_place) ++size[part];
  for (std::uint32_t& part : parts.of_place) {
    if (size[part] <= kSmallPart && number[part] == SmallParts::kLarge)
      number[part] = static_cast<std::uint32_t>(parts.count++);
    part = number[part];
  }
  return parts;
}

std::optional<BakedMesh> bake_mesh(const Mesh& mesh, const std::vector<bool>& two_sided,
                                   std::uint32_t index, const Placements& placements,
                                   const BakeOptions& options, SampleTracer& tracer,
                                   BakeProgress& progress, BakeStatistics& statistics) {
  const bool any_two_sided = std::find(two_sided.begin(), two_sided.end(), true) != two_sided.end();
  const VertexGroups groups = group_vertices(mesh, any_two_sided);
  ValueSums sums(small_parts(mesh, groups), options.sides);
  const std::uint32_t hash = hash_of(options.seed, index);
  const SampledMesh sampled(mesh, groups, two_sided, options.at_vertices, hash);
  SampleRounds rounds(sampled, hash, placements, tracer, sums, progress);
  // At a vertex alone, only a second sample tells the variance.
  const SampleCounts fixed =
      options.at_vertices ? SampleCounts{1, options.rays} : sample_counts(options.rays);
  if (!rounds.run(options, options.at_vertices ? 2 : 1, fixed)) return {};
  sums.choose_sides(true);
  const std::vector<float> squares = sums.squared_errors();
  for (const std::uint32_t group : groups.of_vertex)
    statistics.squared_errors += double{squares[group]};
  statistics.vertices += mesh.positions.size();
  statistics.triangles += mesh.primitive_count();
  return vertex_values(mesh, groups, sums, options.bent, statistics.hidden_vertices);
}

}  // namespace dapple
