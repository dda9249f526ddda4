// Finds triangles whose texture is opaque all over, such as a trunk in the atlas of its leaves. In:
// the textures of a scene, and triangles. Out: whether all texels that look-ups read are opaque.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Thread-safe. A texture is read when a triangle with it is asked for first.
class OpaqueTexels {
 public:
  /// `scene` must outlive the object; its meshes may change.
  explicit OpaqueTexels(const Scene& scene);

  /// Whether the texture's alpha is 1 all over the rectangle around the triangle's texture
  /// coordinates, or of a masked material without vertex alphas such that it is not cut out. The
  /// material and the mesh must have_texture(). Textures of more than 2^20 texels are looked at in
  /// squares of 2, 4 ... texels, so that triangles next to transparent texels may not be found.
  [[nodiscard]] bool cover(const Mesh& mesh, std::uint32_t triangle) const;

 private:
  /// How many squares of a texture have texels below a threshold (a summed-area table: Crow 1984).
  struct Table {
    Table(const Texture* of, int least) : texture(of), threshold(least) {}

    const Texture* texture;
    int threshold;
    std::once_flag made;
    std::uint32_t square = 1, columns = 0, rows = 0;
    std::vector<std::uint32_t> sums;  ///< (columns + 1) by (rows + 1)

    void make();
    [[nodiscard]] bool is_clear(const int (&x)[2], const int (&y)[2]) const;
  };

  std::vector<int> table_of_;         ///< by material; -1: none
  mutable std::deque<Table> tables_;  ///< of different textures or thresholds
};

}  // namespace dapple
