#include "bake/hidden_vertices.hpp"

#include <algorithm>

namespace dapple {

std::vector<HiddenGroup> hidden_groups(const Mesh& mesh, const VertexGroups& groups,
                                       std::vector<bool> known) {
  std::vector<HiddenGroup> all;
  if (std::find(known.begin(), known.end(), false) == known.end()) return all;
  // A ring of vertices each round.
  for (std::size_t begin = 0;; begin = all.size()) {
    std::vector<std::uint32_t> index(known.size(), ~0u);
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
      const std::uint32_t hidden = groups.of_vertex[mesh.indices[corner]];
      if (known[hidden]) continue;
      for (std::size_t other = corner / 3 * 3; other < corner / 3 * 3 + 3; ++other) {
        const std::uint32_t neighbour = groups.of_vertex[mesh.indices[other]];
        if (!known[neighbour]) continue;
        if (index[hidden] == ~0u) {
          index[hidden] = static_cast<std::uint32_t>(all.size());
          all.push_back({hidden, {}});
        }
        all[index[hidden]].sources.push_back(neighbour);
      }
    }
    if (all.size() == begin) return all;
    for (std::size_t i = begin; i < all.size(); ++i) known[all[i].group] = true;
  }
}

}  // namespace dapple
