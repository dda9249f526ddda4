#include "bake/vertex_bake.hpp"

#include <algorithm>
#include <cmath>
#include <future>

#include "bake/vertex_values.hpp"

namespace dapple {
namespace {

/// Samples that are traced between two questions whether to stop: about half a second.
constexpr std::size_t kSamplesAtOnce = 1u << 18;

/// A round multiplies the samples of a triangle by this at most: early variances are uncertain.
constexpr float kMaxGrowth = 4;

/// A round that would take fewer samples of a triangle in the mean does not pay: it visits all.
constexpr double kMinRound = 0.005;

/// Random bits of the first sample's place in a triangle, two for each halving of the sides.
constexpr std::uint32_t kMaxShift = 0xffff;

/// Triangles, or vertex groups, of a mesh, each with a sequence of samples.
class SampledMesh {
 public:
  SampledMesh(const Mesh& mesh, const VertexGroups& groups, const std::vector<bool>& two_sided,
              bool at_vertices, std::uint32_t hash)
      : mesh_(mesh), groups_(groups), two_sided_(two_sided), hash_(hash) {
    if (at_vertices) at_vertices_ = sample_vertices(mesh, groups, two_sided);
    is_at_vertices_ = at_vertices;
  }

  [[nodiscard]] std::size_t size() const {
    return is_at_vertices_ ? at_vertices_.size() : mesh_.primitive_count();
  }

  [[nodiscard]] bool can_be_sampled(std::size_t i) const {
    return is_at_vertices_ ? at_vertices_[i].weight[0] > 0 : has_area(mesh_, i);
  }

  [[nodiscard]] SurfaceSample sample(std::size_t i, std::uint32_t index) const {
    if (is_at_vertices_) return at_vertices_[i];
    // A digital shift, which keeps the parts of the sequence: without it the first sample of all
    // triangles would be their centre, where cards often cross.
    const std::uint32_t shift = hash_of(hash_, static_cast<std::uint32_t>(i)) & kMaxShift;
    return sample_triangle(mesh_, i, groups_, two_sided_[i], index ^ shift);
  }

  /// Vertex groups whose values have part in the samples.
  [[nodiscard]] std::array<std::uint32_t, 3> groups(std::size_t i) const {
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

/// Samples that are traced together.
struct Batch {
  std::vector<SurfaceSample> samples;
  std::vector<std::uint32_t> placement;
  std::uint32_t hash = 0;
};

class VertexBake {
 public:
  VertexBake(const SampledMesh& sampled, std::uint32_t hash, const Placements& placements,
             SampleTracer& tracer, VertexValues& values, BakeProgress& progress)
      : sampled_(sampled),
        hash_(hash),
        placements_(placements),
        tracer_(tracer),
        values_(values),
        progress_(progress),
        taken_(sampled.size()) {}

  /// `samples` of each triangle, both sides. False: stopped.
  bool take(std::uint32_t samples, int rays) {
    rays_ = rays;
    std::vector<std::uint32_t> wanted(taken_.size(), samples);
    return round(wanted);
  }

  /// Rounds until the standard error of nearly all values is `target`, or triangles have `most`
  /// samples.
  bool refine(float target, std::uint32_t most) {
    std::vector<std::uint32_t> wanted(taken_.size());
    for (;;) {
      values_.choose_sides(true);
      const std::vector<float> factors = values_.missing_samples(target);
      double more = 0;
      for (std::size_t i = 0; i < taken_.size(); ++i) {
        float factor = 1;
        for (const std::uint32_t group : sampled_.groups(i))
          factor = std::max(factor, factors[group]);
        const float needed =
            std::ceil(static_cast<float>(taken_[i]) * std::min(factor, kMaxGrowth));
        wanted[i] = std::clamp(static_cast<std::uint32_t>(needed), taken_[i], most);
        more += wanted[i] - taken_[i];
      }
      if (more <= kMinRound * static_cast<double>(taken_.size())) return true;
      progress_.expect(more);
      if (!round(wanted)) return false;
    }
  }

 private:
  /// Takes samples until each triangle has `wanted` of them.
  bool round(const std::vector<std::uint32_t>& wanted) {
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      if (!sampled_.can_be_sampled(i)) taken_[i] = wanted[i];
      for (; taken_[i] < wanted[i]; ++taken_[i]) {
        SurfaceSample sample = sampled_.sample(i, taken_[i]);
        choose_sides(i, sample);
        if (sample.front || sample.back) samples_.push_back(sample);
      }
      if (samples_.size() >= kSamplesAtOnce && !trace()) return false;
    }
    return trace() && trace();
  }

  /// Leaves out sides that count for no vertex.
  void choose_sides(std::size_t i, SurfaceSample& sample) const {
    bool front = false, back = false;
    for (const std::uint32_t group : sampled_.groups(i)) {
      front = front || values_.counts(group, false);
      back = back || values_.counts(group, true);
    }
    sample.front = front;
    sample.back = sample.back && back;
  }

  /// Starts tracing the samples of the list, and adds what the batch before found meanwhile.
  bool trace() {
    Batch batch;
    batch.samples.swap(samples_);
    if (!batch.samples.empty()) {
      const std::uint32_t hash = hash_of(hash_, batch_++);
      batch.placement.resize(batch.samples.size());
      const auto count = static_cast<std::uint32_t>(placements_.to_world.size());
      for (std::uint32_t i = 0; i < batch.placement.size() && count > 1; ++i)
        batch.placement[i] = hash_of(hash, i) % count;
      batch.hash = hash;
    }
    std::optional<TracedSamples> found;
    if (traced_.valid()) found = traced_.get();
    Batch before = std::move(batch_traced_);
    batch_traced_ = std::move(batch);
    if (!batch_traced_.samples.empty())
      traced_ = std::async(std::launch::async, [this] {
        return tracer_.trace(batch_traced_.samples, batch_traced_.placement, placements_, rays_,
                             batch_traced_.hash);
      });
    if (!found) return true;
    for (std::size_t i = 0; i < before.samples.size(); ++i)
      values_.add(before.samples[i], found->front[i], found->back[i]);
    return progress_.add(before.samples.size());
  }

  const SampledMesh& sampled_;
  std::uint32_t hash_, batch_ = 0;
  const Placements& placements_;
  SampleTracer& tracer_;
  VertexValues& values_;
  BakeProgress& progress_;
  int rays_ = kRaysPerSample;
  std::vector<std::uint32_t> taken_;  ///< samples of each triangle
  std::vector<SurfaceSample> samples_;
  Batch batch_traced_;
  std::future<TracedSamples> traced_;  ///< last: its destructor waits for the thread
};

}  // namespace

std::vector<bool> two_sided_triangles(const Scene& scene, const Mesh& mesh, BakeSides sides) {
  std::vector<bool> two_sided(mesh.primitive_count());
  for (std::size_t t = 0; t < two_sided.size(); ++t)
    two_sided[t] = is_two_sided(scene.materials[mesh.materials[t]], sides);
  return two_sided;
}

std::optional<BakedMesh> bake_mesh(const Mesh& mesh, const std::vector<bool>& two_sided,
                                   std::uint32_t index, const Placements& placements,
                                   const BakeOptions& options, SampleTracer& tracer,
                                   BakeProgress& progress, BakeStatistics& statistics) {
  const bool any_two_sided = std::find(two_sided.begin(), two_sided.end(), true) != two_sided.end();
  const VertexGroups groups = group_vertices(mesh, any_two_sided);
  VertexValues values(mesh, groups, options.sides);
  const std::uint32_t hash = hash_of(options.seed, index);
  const SampledMesh sampled(mesh, groups, two_sided, options.at_vertices, hash);
  VertexBake bake(sampled, hash, placements, tracer, values, progress);
  if (options.target_error > 0) {
    // At a vertex alone, only a second sample tells the variance.
    if (!bake.take(options.at_vertices ? 2 : 1, kRaysPerSample)) return {};
    if (!bake.refine(options.target_error,
                     static_cast<std::uint32_t>(options.rays / kRaysPerSample)))
      return {};
  } else {
    const SampleCounts counts =
        options.at_vertices ? SampleCounts{1, options.rays} : sample_counts(options.rays);
    if (!bake.take(static_cast<std::uint32_t>(counts.samples), counts.rays)) return {};
  }
  values.choose_sides(true);
  const std::vector<float> squares = values.squared_errors();
  for (const std::uint32_t group : groups.of_vertex)
    statistics.squared_errors += double{squares[group]};
  statistics.vertices += mesh.positions.size();
  statistics.triangles += mesh.primitive_count();
  return values.finish(options.bent, statistics.hidden_vertices);
}

}  // namespace dapple
