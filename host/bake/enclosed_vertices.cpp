#include "bake/enclosed_vertices.hpp"

#include <algorithm>

namespace dapple {

std::vector<EnclosedGroup> enclosed_groups(const Mesh& mesh, const VertexGroups& groups,
                                           std::vector<bool> known) {
  std::vector<EnclosedGroup> all;
  if (std::find(known.begin(), known.end(), false) == known.end()) return all;
  // A ring of vertices each round.
  for (std::size_t begin = 0;; begin = all.size()) {
    std::vector<std::uint32_t> index(known.size(), ~0u);
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
      const std::uint32_t enclosed = groups.of_vertex[mesh.indices[corner]];
      if (known[enclosed]) continue;
      for (std::size_t other = corner / 3 * 3; other < corner / 3 * 3 + 3; ++other) {
        const std::uint32_t neighbour = groups.of_vertex[mesh.indices[other]];
        if (!known[neighbour]) continue;
        if (index[enclosed] == ~0u) {
          index[enclosed] = static_cast<std::uint32_t>(all.size());
          all.push_back({enclosed, {}});
        }
        all[index[enclosed]].sources.push_back(neighbour);
      }
    }
    if (all.size() == begin) return all;
    for (std::size_t i = begin; i < all.size(); ++i) known[all[i].group] = true;
  }
}

}  // namespace dapple
