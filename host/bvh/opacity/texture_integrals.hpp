// Mean opacities of parts of textured triangles, from mip levels of their textures.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "bvh/opacity/opacity_mip_levels.hpp"
#include "bvh/storage/textured_triangle.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// The opacity of a texture whose alpha is multiplied by `factor`; `cutoff` < 0: not cut out.
struct OpacityTexture {
  int texture;  ///< index into Scene::textures
  float factor, cutoff;
  auto operator<=>(const OpacityTexture&) const = default;
};

/// Mip levels that the objects of a scene share. Thread-safe. Those that were made last stay, as do
/// those in use.
class SharedMipLevels {
 public:
  /// `scene` must outlive the object; its meshes may change. `most_bytes`: of those that stay.
  explicit SharedMipLevels(const Scene& scene, std::size_t most_bytes = std::size_t{256} << 20)
      : textures_(scene.textures), most_bytes_(most_bytes) {}

  /// Makes them if they are not there.
  std::shared_ptr<const OpacityMipLevels> of(const OpacityTexture& texture);

 private:
  struct Entry {
    std::once_flag made;
    std::shared_ptr<const OpacityMipLevels> levels;
  };
  std::shared_ptr<Entry> entry_of(const OpacityTexture& texture);
  void keep(std::shared_ptr<Entry> entry, std::size_t bytes);

  const std::vector<Texture>& textures_;
  std::size_t most_bytes_;
  std::mutex mutex_;
  std::map<OpacityTexture, std::weak_ptr<Entry>> entries_;
  std::deque<std::pair<std::shared_ptr<Entry>, std::size_t>> kept_;  ///< with their bytes
  std::size_t kept_bytes_ = 0;
};

/// Mean opacities of parts of one triangle.
class TriangleIntegral {
 public:
  /// `levels`: of the triangle's texture, or null: it has none. They must outlive the object.
  TriangleIntegral(const TexturedCorners& corners, const Material& material,
                   const OpacityMipLevels* levels);

  /// Around barycentrics (u, v), over an area that is `share` of the triangle's, [0,1].
  [[nodiscard]] float mean(float u, float v, float share) const;

  /// Of the whole triangle, by the middles of `divisions` times `divisions` parts.
  [[nodiscard]] float mean_of_parts(std::size_t divisions) const;

 private:
  TexturedCorners corners_;
  float factor_, cutoff_;
  float texels_ = 0;     ///< the triangle's area in the texture; 0: it is looked up itself
  float narrowest_ = 0;  ///< its least height there: other parts of an atlas stay out
  const OpacityMipLevels* levels_;
};

class TextureIntegrals {
 public:
  /// Of no triangles.
  TextureIntegrals() = default;
  /// Gets the mip levels that the `textured` triangles need from `shared`. `scene` must outlive
  /// this object.
  TextureIntegrals(const Scene& scene, std::span<const TexturedTriangle> textured,
                   SharedMipLevels& shared);
  /// Makes them for itself.
  TextureIntegrals(const Scene& scene, std::span<const TexturedTriangle> textured);

  /// For the same triangles in another pose: `scene` has the same materials and textures, and must
  /// outlive this object.
  void move_to(const Scene& scene) { materials_ = &scene.materials; }

  [[nodiscard]] TriangleIntegral of(const TexturedTriangle& triangle) const;

 private:
  [[nodiscard]] OpacityTexture texture_of(const TexturedCorners& corners) const;

  const std::vector<Material>* materials_ = nullptr;
  std::vector<std::pair<OpacityTexture, std::shared_ptr<const OpacityMipLevels>>>
      levels_;  ///< sorted
};

}  // namespace dapple
