// Which points lie inside closed geometry. In: a scene. Out: for a point above a surface, whether a
// closed part surrounds it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/inside/box_tree.hpp"
#include "dapple/scene.hpp"

namespace dapple {

class ClosedGeometry {
 public:
  /// Keeps what it needs of the triangles. Most of the time is taken in prepare().
  explicit ClosedGeometry(Scene scene);

  /// Finds the closed parts, the first time that it is called. Linear but for parallel sorts.
  void prepare();

  /// Whether the point, in world space, lies inside a closed opaque part, judged by rays to the
  /// side of `normal`: all of them leave one part once more than they enter it. Parts whose front
  /// faces inwards, such as rooms, surround nothing; nor do leaves or terrains (closed_parts.hpp).
  /// prepare() must have been called.
  [[nodiscard]] bool surrounds(const V3f& point, const V3f& normal) const;

 private:
  struct Part {
    std::uint32_t begin = 0, end = 0;  ///< in Solids::triangles
    Box3f bounds;
    BoxTree tree;  ///< of the triangles
  };
  /// The closed parts of a mesh.
  struct Solids {
    std::vector<std::array<V3f, 3>> triangles;
    std::vector<Part> parts;
    BoxTree tree_of_parts;
    [[nodiscard]] bool surrounds(const M44f& to_object, const V3f& point, const V3f& normal) const;
  };
  struct Placement {
    M44f to_object;
    std::uint32_t mesh;
  };

  /// The triangles of a mesh.
  struct Surface {
    Mesh mesh;
    std::vector<bool> opaque;  ///< of each triangle
  };

  static Solids solids_of(const Surface& surface);

  std::vector<Surface> surfaces_;    ///< of each mesh, until prepare()
  std::vector<Instance> instances_;  ///< until prepare()
  bool is_prepared_ = false;
  std::vector<Solids> of_mesh_;
  std::vector<Placement> placements_;  ///< of meshes with closed parts
  BoxTree boxes_;                      ///< of placements_, in world space
};

}  // namespace dapple
