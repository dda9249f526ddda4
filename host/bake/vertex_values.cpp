#include "bake/vertex_values.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>

namespace dapple {
namespace {

/// Up to this AO a vertex sees nothing: it lies inside closed geometry. Single samples are not
/// judged: all of a few rays may be blocked by chance.
constexpr float kHidden = 1e-3f;

/// Samples after which a vertex is known to see nothing.
constexpr float kSamplesOfHidden = 32;

/// A side is surely the brighter one if the difference is so many standard errors.
constexpr float kSure = 1.75f;

constexpr std::uint32_t kLarge = ~0u;

/// Vertex groups that one thread takes at a time.
constexpr std::size_t kGroupsAtOnce = 1u << 14;

/// The variance of samples is pooled over values in this many intervals of AO.
constexpr int kIntervals = 16;

/// Degrees of freedom that the pooled variance counts beside a vertex's own.
constexpr float kPooledFreedom = 4;

}  // namespace

void VertexValues::Side::add(float w, const SideValue& value) {
  weight += w;
  weight_squares += w * w;
  ao += w * value.ao;
  ao_squares += w * value.ao * value.ao;
  bent += value.bent * w;
}

float VertexValues::Side::count() const {
  return weight_squares > 0 ? weight * weight / weight_squares : 0;
}

float VertexValues::Side::squared_deviations() const {
  return weight > 0 ? std::max(0.0f, ao_squares / weight - mean() * mean()) * count() : 0.0f;
}

/// The variance of samples as a function of the AO of the value that they belong to: that of a few
/// samples around one vertex says little.
class VertexValues::PooledVariance {
 public:
  void add(const Side& side) {
    const float freedom = side.count() - 1;
    if (freedom < 0.5f) return;
    for (Pool* pool : {&of_interval_[interval(side.mean())], &all_}) {
      pool->squares += double{side.squared_deviations()};
      pool->freedom += double{freedom};
    }
  }

  PooledVariance& operator+=(const PooledVariance& other) {
    for (std::size_t i = 0; i < of_interval_.size(); ++i) of_interval_[i] += other.of_interval_[i];
    all_ += other.all_;
    return *this;
  }

  /// Of the samples of `side`, its own deviations included.
  [[nodiscard]] float of(const Side& side) const {
    const float own = std::max(0.0f, side.count() - 1);
    return (kPooledFreedom * pooled(side.mean()) + side.squared_deviations()) /
           (kPooledFreedom + own);
  }

 private:
  struct Pool {
    double squares = 0, freedom = 0;
    void operator+=(const Pool& other) {
      squares += other.squares;
      freedom += other.freedom;
    }
  };

  static std::size_t interval(float ao) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(ao * kIntervals), 0, kIntervals - 1));
  }

  [[nodiscard]] float pooled(float ao) const {
    // Without any repeated sample: of rays that each find everything or nothing.
    const double all =
        all_.freedom > 0 ? all_.squares / all_.freedom : double{ao * (1 - ao)} / kRaysPerSample;
    const Pool& pool = of_interval_[interval(ao)];
    return static_cast<float>((pool.squares + double{kPooledFreedom} * all) /
                              (pool.freedom + double{kPooledFreedom}));
  }

  std::array<Pool, kIntervals> of_interval_;
  Pool all_;
};

VertexValues::VertexValues(const Mesh& mesh, const VertexGroups& groups, BakeSides sides)
    : mesh_(mesh),
      groups_(groups),
      sides_(sides),
      of_group_(groups.count),
      part_(connected_parts(mesh, groups)),
      chosen_(groups.count, Chosen::both) {
  std::vector<std::uint32_t> size(groups.count), number(groups.count, kLarge);
  for (const std::uint32_t part : part_) ++size[part];
  std::uint32_t count = 0;
  for (std::uint32_t& part : part_) {
    if (size[part] <= kSmallPart && number[part] == kLarge) number[part] = count++;
    part = number[part];
  }
  of_part_.resize(count);
}

void VertexValues::add(const SurfaceSample& sample, const SideValue& front, const SideValue& back) {
  const auto add_to = [&](Group& group, float weight) {
    if (sample.front) group.front.add(weight, front);
    if (sample.back) group.back.add(weight, back);
  };
  for (std::size_t k = 0; k < 3; ++k)
    if (sample.weight[k] > 0) add_to(of_group_[sample.group[k]], sample.weight[k]);
  const std::uint32_t part = part_[sample.group[0]];
  if (part != kLarge)
    add_to(of_part_[part], sample.weight[0] + sample.weight[1] + sample.weight[2]);
}

// In parts of fixed size, so that the sums do not depend on the number of threads.
VertexValues::PooledVariance VertexValues::pooled_variance() const {
  const auto add_range = [&](const tbb::blocked_range<std::size_t>& range, PooledVariance sum) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      sum.add(of_group_[i].front);
      sum.add(of_group_[i].back);
    }
    return sum;
  };
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, of_group_.size(), kGroupsAtOnce), PooledVariance(),
      add_range, [](PooledVariance a, const PooledVariance& b) { return a += b; });
}

// By sums over a small part: means of single vertices are noisy, and the larger of two is biased.
void VertexValues::choose_sides(bool surely) {
  if (sides_ == BakeSides::mean) return;
  const PooledVariance variance = pooled_variance();
  const auto choose = [&](const Group& values) {
    if (values.back.weight <= 0) return Chosen::front;
    const float difference = values.back.mean() - values.front.mean();
    const float square = variance.of(values.front) / values.front.count() +
                         variance.of(values.back) / values.back.count();
    if (surely && difference * difference < kSure * kSure * square) return Chosen::both;
    return difference > 0 ? Chosen::back : Chosen::front;
  };
  std::vector<Chosen> of_part(of_part_.size());
  tbb::parallel_for(std::size_t{0}, of_part.size(),
                    [&](std::size_t i) { of_part[i] = choose(of_part_[i]); });
  tbb::parallel_for(std::size_t{0}, chosen_.size(), [&](std::size_t i) {
    chosen_[i] = part_[i] == kLarge ? choose(of_group_[i]) : of_part[part_[i]];
  });
}

std::vector<float> VertexValues::squared_errors() const {
  const PooledVariance variance = pooled_variance();
  std::vector<float> squares(of_group_.size());
  tbb::parallel_for(std::size_t{0}, squares.size(), [&](std::size_t i) {
    const Group& group = of_group_[i];
    for (const bool back : {false, true}) {
      const Side& side = back ? group.back : group.front;
      if (counts(static_cast<std::uint32_t>(i), back) && side.weight > 0)
        squares[i] = std::max(squares[i], variance.of(side) / side.count());
    }
    if (sides_ == BakeSides::mean && group.back.weight > 0) squares[i] *= 0.5f;  // of two of them
  });
  return squares;
}

std::vector<float> VertexValues::missing_samples(float target) const {
  std::vector<float> factors = squared_errors();
  tbb::parallel_for(std::size_t{0}, factors.size(), [&](std::size_t i) {
    const Group& group = of_group_[i];
    const float samples = group.front.count() + group.back.count();
    const bool may_be_hidden =
        samples > 0 && std::max(group.front.mean(), group.back.mean()) <= kHidden;
    factors[i] = std::max(
        {1.0f, factors[i] / (target * target), may_be_hidden ? kSamplesOfHidden / samples : 1.0f});
  });
  return factors;
}

std::vector<VertexValues::Value> VertexValues::known_values() const {
  std::vector<Value> values(groups_.count);
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    const Group& group = of_group_[i];
    if (group.front.weight <= 0) {  // without a triangle there is nothing to occlude
      values[i] = {1, V3f(0, 0, 0), true};
      continue;
    }
    if (std::max(group.front.mean(), group.back.mean()) <= kHidden) continue;
    // The larger of two means that differ by noise would be too large.
    const bool both = counts(i, false) && counts(i, true) && group.back.weight > 0;
    const bool back = both ? group.back.mean() > group.front.mean() : counts(i, true);
    const Side& chosen = back ? group.back : group.front;
    const float ao = both ? 0.5f * (group.front.mean() + group.back.mean()) : chosen.mean();
    const V3f bent =
        both && sides_ == BakeSides::mean ? group.front.bent + group.back.bent : chosen.bent;
    values[i] = {std::clamp(ao, 0.0f, 1.0f), bent.normalized(), true};
  }
  return values;
}

// Breadth first over the triangles' edges, a ring of vertices each round.
void VertexValues::spread_to_hidden(std::vector<Value>& values) const {
  struct Sum {
    double ao = 0;
    V3f bent{0, 0, 0};
    int count = 0;
  };
  for (bool spreads = true; spreads;) {
    std::vector<std::pair<std::uint32_t, Sum>> ring;
    std::vector<std::uint32_t> place(values.size(), ~0u);
    for (std::size_t corner = 0; corner < mesh_.indices.size(); ++corner) {
      const std::uint32_t hidden = groups_.of_vertex[mesh_.indices[corner]];
      if (values[hidden].known) continue;
      for (std::size_t other = corner / 3 * 3; other < corner / 3 * 3 + 3; ++other) {
        const Value& neighbour = values[groups_.of_vertex[mesh_.indices[other]]];
        if (!neighbour.known) continue;
        if (place[hidden] == ~0u) {
          place[hidden] = static_cast<std::uint32_t>(ring.size());
          ring.push_back({hidden, {}});
        }
        Sum& sum = ring[place[hidden]].second;
        sum.ao += double{neighbour.ao};
        sum.bent += neighbour.bent;
        ++sum.count;
      }
    }
    for (const auto& [group, sum] : ring)
      values[group] = {static_cast<float>(sum.ao / sum.count), sum.bent.normalized(), true};
    spreads = !ring.empty();
  }
}

BakedMesh VertexValues::finish(bool bent, std::size_t& hidden) const {
  std::vector<Value> values = known_values();
  const auto hidden_groups =
      std::count_if(values.begin(), values.end(), [](const Value& v) { return !v.known; });
  if (hidden_groups > 0) spread_to_hidden(values);
  hidden += static_cast<std::size_t>(hidden_groups);
  BakedMesh baked;
  baked.ao.resize(mesh_.positions.size());
  if (bent) baked.bent.resize(mesh_.positions.size());
  for (std::size_t vertex = 0; vertex < baked.ao.size(); ++vertex) {
    const Value& value = values[groups_.of_vertex[vertex]];
    baked.ao[vertex] = value.ao;
    if (bent) baked.bent[vertex] = value.bent;
  }
  return baked;
}

}  // namespace dapple
