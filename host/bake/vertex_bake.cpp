#include "bake/vertex_bake.hpp"

#include <algorithm>

#include "bake/enclosed_vertices.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

/// Random bits of the first sample's place in a triangle, two for each halving of the sides.
constexpr std::uint32_t kMaxShift = 0xffff;

/// Rays to a light from one side of a sample, at most.
constexpr std::int64_t kMostLightRays = 1 << 16;

/// Triangles, or vertex groups, of a mesh, each with a sequence of samples.
class SampledMesh : public SampledSurface {
 public:
  SampledMesh(const SampledTriangles& triangles, bool at_vertices, std::uint32_t hash)
      : triangles_(triangles), mesh_(triangles.mesh), hash_(hash) {
    if (at_vertices) at_vertices_ = sample_vertices(triangles);
    is_at_vertices_ = at_vertices;
  }

  [[nodiscard]] std::size_t size() const override {
    return is_at_vertices_ ? at_vertices_.size() : mesh_.primitive_count();
  }

  [[nodiscard]] bool can_be_sampled(std::size_t i) const override {
    return is_at_vertices_ ? at_vertices_[i].weight[0] > 0 : has_area(mesh_, i);
  }

  [[nodiscard]] SurfaceSample sample(std::size_t i, std::uint32_t index,
                                     std::uint32_t sequence) const override {
    if (is_at_vertices_) return at_vertices_[i];
    // A digital shift, which keeps the parts of the sequence: without it the first sample of all
    // triangles would be their centre, where cards often cross.
    const std::uint32_t shift =
        hash_of(hash_ + sequence, static_cast<std::uint32_t>(i)) & kMaxShift;
    return sample_triangle(triangles_, i, index ^ shift);
  }

  [[nodiscard]] std::array<std::uint32_t, 3> places(std::size_t i) const override {
    if (is_at_vertices_) {
      const auto group = static_cast<std::uint32_t>(i);
      return {group, group, group};
    }
    const std::uint32_t* corner = &mesh_.indices[3 * i];
    const std::vector<std::uint32_t>& group = triangles_.groups.of_vertex;
    return {group[corner[0]], group[corner[1]], group[corner[2]]};
  }

 private:
  SampledTriangles triangles_;
  const Mesh& mesh_;
  std::uint32_t hash_;
  std::vector<SurfaceSample> at_vertices_;
  bool is_at_vertices_ = false;
};

/// Values of one mesh by vertex group.
struct GroupValues {
  std::vector<float> ao;
  std::vector<V3f> bent;
  std::vector<std::vector<V3f>> light;

  GroupValues(const std::vector<PlaceValue>& values, bool with_bent) {
    for (const PlaceValue& value : values) {
      ao.push_back(value.ao);
      if (with_bent) bent.push_back(value.bent);
    }
  }

  /// Gives an enclosed group the mean of others.
  void fill(const EnclosedGroup& enclosed) {
    const auto count = static_cast<float>(enclosed.sources.size());
    const auto sum = [&](const auto& values, auto start) {
      for (const std::uint32_t source : enclosed.sources) start += values[source];
      return start;
    };
    ao[enclosed.group] = sum(ao, 0.0f) / count;
    if (!bent.empty()) bent[enclosed.group] = sum(bent, V3f(0, 0, 0)).normalized();
    for (std::vector<V3f>& of_light : light)
      of_light[enclosed.group] = sum(of_light, V3f(0, 0, 0)) / count;
  }

  [[nodiscard]] BakedMesh at_vertices(const VertexGroups& groups) const {
    BakedMesh baked;
    const auto spread = [&](const auto& values, auto& out) {
      if (values.empty()) return;
      for (const std::uint32_t group : groups.of_vertex) out.push_back(values[group]);
    };
    spread(ao, baked.ao);
    spread(bent, baked.bent);
    baked.light.resize(light.size());
    for (std::size_t l = 0; l < light.size(); ++l) spread(light[l], baked.light[l]);
    return baked;
  }
};

/// Adds the squared errors of the values at all vertices to `sum`; returns how many have samples.
std::size_t add_errors(const VertexGroups& groups, const ValueSums& sums, double& sum) {
  const std::vector<float> squares = sums.squared_errors();
  std::size_t sampled = 0;
  for (const std::uint32_t group : groups.of_vertex) {
    sum += double{squares[group]};
    sampled += sums.is_sampled(group) ? 1 : 0;
  }
  return sampled;
}

}  // namespace

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

RoundOptions round_options(const BakeOptions& options, std::uint32_t first,
                           const Placements& placements, bool lights) {
  RoundOptions rounds;
  rounds.target_error = options.target_error;
  rounds.first = first;
  rounds.limit = static_cast<std::uint32_t>(options.rays / kRaysPerSample);
  rounds.fixed = sample_counts(options.rays, placements.to_world.size());
  if (lights) {
    // As AO has, up to 64 or a few more: as many in each placement. What is left of options.rays
    // makes more rays of each.
    constexpr int kMaxLightSamples = 64;
    const int each = std::max(1, static_cast<int>(placements.to_world.size()));
    rounds.fixed.samples =
        std::min(rounds.fixed.samples, (kMaxLightSamples + each - 1) / each * each);
    const int samples = std::max(1, options.rays / kRaysPerSample);
    const std::int64_t light_rays =
        std::int64_t{options.light_rays} * samples / rounds.fixed.samples;
    rounds.rays = options.light_rays;
    rounds.fixed.rays =
        static_cast<int>(std::clamp<std::int64_t>(light_rays, options.light_rays, kMostLightRays));
  }
  return rounds;
}

std::optional<BakedMesh> bake_mesh(const Mesh& mesh, const std::vector<bool>& two_sided,
                                   std::uint32_t index, const Placements& placements,
                                   const BakeOptions& options, BakeTracing& tracing) {
  const VertexGroups groups = group_vertices(mesh, two_sided);
  const std::uint32_t hash = hash_of(options.seed, index);
  const SampledMesh sampled({mesh, groups, two_sided, options.normals}, options.at_vertices, hash);
  // At a vertex alone, only a second sample tells the variance.
  const std::uint32_t first = options.at_vertices ? 2 : 1;
  ValueSums sums(small_parts(mesh, groups), options.sides);
  SampleRounds rounds(sampled, hash, placements, tracing, sums, options.sides);
  RoundOptions how = round_options(options, first, placements, false);
  if (options.at_vertices)
    how.fixed = sample_counts(options.rays, placements.to_world.size(), true);
  if (!rounds.run(how)) return {};
  BakeStatistics& statistics = tracing.statistics;
  statistics.sampled_values += add_errors(groups, sums, statistics.squared_errors);
  const std::vector<PlaceValue> of_group = sums.values();
  GroupValues values(of_group, options.bent);
  std::vector<bool> known, filled(groups.count);
  for (const PlaceValue& value : of_group) known.push_back(value.known);
  if (tracing.lights > 0) {
    ValueSums light(small_parts(mesh, groups), options.sides, tracing.lights);
    SampleRounds light_rounds(sampled, ~hash, placements, tracing, light, options.sides, &sums);
    if (!light_rounds.run(round_options(options, first, placements, true))) return {};
    add_errors(groups, light, statistics.squared_light_errors);
    for (std::size_t l = 0; l < tracing.lights; ++l) values.light.push_back(light.light_values(l));
    for (std::uint32_t i = 0; i < known.size(); ++i) known[i] = known[i] && !light.is_inside(i);
  }
  for (const EnclosedGroup& enclosed : enclosed_groups(mesh, groups, known)) {
    values.fill(enclosed);
    filled[enclosed.group] = true;
  }
  for (const std::uint32_t group : groups.of_vertex) {
    if (filled[group]) ++statistics.enclosed_vertices;
    if (of_group[group].dark) ++statistics.dark_vertices;
  }
  statistics.vertices += mesh.positions.size();
  statistics.triangles += mesh.primitive_count();
  return values.at_vertices(groups);
}

}  // namespace dapple
