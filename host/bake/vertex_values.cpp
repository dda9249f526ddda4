#include "bake/vertex_values.hpp"

#include <algorithm>

namespace dapple {
namespace {

/// Up to this AO a vertex sees nothing: it lies inside closed geometry. Single samples are not
/// judged: all of a few rays may be blocked by chance.
constexpr float kHidden = 1e-3f;

/// Sheets of at most so many vertices, such as leaves, have one better side.
constexpr std::size_t kSmallPart = 64;

}  // namespace

void VertexValues::Side::add(float w, const SideValue& value) {
  weight += double{w};
  ao += double{w} * double{value.ao};
  bent += Imath::V3d(value.bent) * double{w};
}

void VertexValues::add(const SurfaceSample& sample, const SideValue& front, const SideValue& back) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (sample.weight[k] <= 0) continue;
    Group& group = of_group_[sample.group[k]];
    group.front.add(sample.weight[k], front);
    if (sample.two_sided) group.back.add(sample.weight[k], back);
  }
}

// By sums over the part: means of single vertices are noisy, and the larger of two would be biased.
std::vector<bool> VertexValues::parts_that_show_their_back() const {
  const std::vector<std::uint32_t> part = connected_parts(mesh_, groups_);
  std::vector<std::size_t> size(groups_.count);
  std::vector<double> difference(groups_.count);
  for (std::size_t group = 0; group < groups_.count; ++group) {
    const Group& values = of_group_[group];
    ++size[part[group]];
    if (values.back.weight > 0)
      difference[part[group]] += (values.back.mean() - values.front.mean()) * values.back.weight;
  }
  std::vector<bool> back(groups_.count);
  for (std::size_t group = 0; group < groups_.count; ++group) {
    const Group& values = of_group_[group];
    back[group] = values.back.weight > 0 &&
                  (size[part[group]] <= kSmallPart ? difference[part[group]] > 0
                                                   : values.back.mean() > values.front.mean());
  }
  return back;
}

std::vector<VertexValues::Value> VertexValues::known_values() const {
  std::vector<Value> values(groups_.count);
  const bool mean = sides_ == BakeSides::mean;
  const std::vector<bool> back =
      mean ? std::vector<bool>(groups_.count) : parts_that_show_their_back();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Group& group = of_group_[i];
    if (group.front.weight <= 0) {  // without a triangle there is nothing to occlude
      values[i] = {1, V3f(0, 0, 0), true};
      continue;
    }
    if (std::max(group.front.mean(), group.back.mean()) <= kHidden) continue;
    const bool both = mean && group.back.weight > 0;
    const Side& chosen = back[i] ? group.back : group.front;
    const double ao = both ? 0.5 * (group.front.mean() + group.back.mean()) : chosen.mean();
    const Imath::V3d bent = both ? group.front.bent + group.back.bent : chosen.bent;
    values[i] = {static_cast<float>(std::clamp(ao, 0.0, 1.0)), V3f(bent).normalized(), true};
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
