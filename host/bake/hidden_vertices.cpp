#include "bake/hidden_vertices.hpp"

namespace dapple {

// Breadth first over the triangles' edges, a ring of vertices each round.
void spread_to_hidden(const Mesh& mesh, const VertexGroups& groups,
                      std::vector<PlaceValue>& values) {
  struct Sum {
    double ao = 0;
    V3f bent{0, 0, 0};
    int count = 0;
  };
  for (bool spreads = true; spreads;) {
    std::vector<std::pair<std::uint32_t, Sum>> ring;
    std::vector<std::uint32_t> index(values.size(), ~0u);
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
      const std::uint32_t hidden = groups.of_vertex[mesh.indices[corner]];
      if (values[hidden].known) continue;
      for (std::size_t other = corner / 3 * 3; other < corner / 3 * 3 + 3; ++other) {
        const PlaceValue& neighbour = values[groups.of_vertex[mesh.indices[other]]];
        if (!neighbour.known) continue;
        if (index[hidden] == ~0u) {
          index[hidden] = static_cast<std::uint32_t>(ring.size());
          ring.push_back({hidden, {}});
        }
        Sum& sum = ring[index[hidden]].second;
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

}  // namespace dapple
