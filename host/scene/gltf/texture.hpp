// Reads the images that materials need. In: the index of a glTF texture; out: an alpha texture in
// Scene::textures, which equal uses share, or the mean colour of an emissive texture.
#pragma once

#include <map>
#include <string>
#include <tuple>

#include "dapple/scene.hpp"
#include "scene/gltf/document.hpp"

namespace dapple::gltf {

class TextureReader {
 public:
  TextureReader(const Document& document, Scene& scene) : document_(document), scene_(scene) {}

  /// Returns the index in Scene::textures of a glTF texture's alpha. Throws Error input, naming
  /// `user`, when the image is missing, corrupt or in a format that dapple cannot read.
  int alpha_texture(int texture, const std::string& user);

  /// Returns the mean linear colour of a glTF texture. Throws like alpha_texture().
  [[nodiscard]] V3f mean_color(int texture, const std::string& user) const;

 private:
  using Key = std::tuple<int, Wrap, Wrap, bool>;  // image, wrap_s, wrap_t, nearest

  const Document& document_;
  Scene& scene_;
  std::map<Key, int> loaded_;
  std::uint64_t texels_ = 0;  ///< of all textures in the scene
};

}  // namespace dapple::gltf
