#include "bake/enclosed_vertices.hpp"

#include <algorithm>
#include <array>

namespace dapple {
namespace {

/// The corners of triangles at each group that is not known, one after the other.
class CornersOfGroups {
 public:
  CornersOfGroups(const Mesh& mesh, const VertexGroups& groups, const std::vector<bool>& known)
      : mesh_(mesh), groups_(groups), first_(groups.count + 1) {
    for (std::size_t i = 0; i < mesh.indices.size(); ++i)
      if (!known[group(i)]) ++first_[group(i) + 1];
    for (std::size_t g = 0; g < groups.count; ++g) first_[g + 1] += first_[g];
    corners_.resize(first_.back());
    std::vector<std::size_t> next = first_;
    for (std::size_t i = 0; i < mesh.indices.size(); ++i)
      if (!known[group(i)]) corners_[next[group(i)]++] = i;
  }

  [[nodiscard]] std::uint32_t group(std::size_t corner) const {
    return groups_.of_vertex[mesh_.indices[corner]];
  }

  /// Calls visit(group) for each corner of each triangle around a group, its own corners too.
  template <class Visit>
  void visit_triangles(std::uint32_t of, const Visit& visit) const {
    for (std::size_t i = first_[of]; i < first_[of + 1]; ++i)
      for (std::size_t k = 0; k < 3; ++k) visit(group(corners_[i] / 3 * 3 + k));
  }

 private:
  const Mesh& mesh_;
  const VertexGroups& groups_;
  std::vector<std::size_t> first_, corners_;
};

}  // namespace

std::vector<EnclosedGroup> enclosed_groups(const Mesh& mesh, const VertexGroups& groups,
                                           std::vector<bool> known) {
  std::vector<EnclosedGroup> all;
  if (std::find(known.begin(), known.end(), false) == known.end()) return all;
  const CornersOfGroups corners(mesh, groups, known);
  std::vector<std::uint32_t> ring;  // groups beside known ones, each once
  std::vector<bool> listed = known;
  const auto list = [&](std::uint32_t group) {
    if (listed[group]) return;
    listed[group] = true;
    ring.push_back(group);
  };
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const std::array of = {corners.group(3 * t), corners.group(3 * t + 1),
                           corners.group(3 * t + 2)};
    if (known[of[0]] || known[of[1]] || known[of[2]])
      for (const std::uint32_t group : of) list(group);
  }
  while (!ring.empty()) {
    const std::size_t begin = all.size();
    for (const std::uint32_t group : ring) {
      EnclosedGroup& enclosed = all.emplace_back(EnclosedGroup{group, {}});
      corners.visit_triangles(group, [&](std::uint32_t beside) {
        if (known[beside]) enclosed.sources.push_back(beside);
      });
    }
    ring.clear();
    for (std::size_t i = begin; i < all.size(); ++i) known[all[i].group] = true;
    for (std::size_t i = begin; i < all.size(); ++i) corners.visit_triangles(all[i].group, list);
  }
  return all;
}

}  // namespace dapple
