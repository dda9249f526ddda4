// Images that somebody needs: alpha textures into Scene::textures, shared between equal
// uses, and the mean colour of emissive ones.
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

  /// The index in Scene::textures of a glTF texture's alpha. Throws Error input, naming
  /// `user`, when its image is missing, corrupt or of a kind that cannot be read.
  int alpha_texture(int texture, const std::string& user);

  /// The mean linear colour of a glTF texture. Throws Error input as alpha_texture does.
  [[nodiscard]] V3f mean_color(int texture, const std::string& user) const;

 private:
  using Key = std::tuple<int, Wrap, Wrap, bool>;  // image, wrap_s, wrap_t, nearest

  const Document& document_;
  Scene& scene_;
  std::map<Key, int> loaded_;
  std::uint64_t texels_ = 0;  ///< of all textures in the scene
};

}  // namespace dapple::gltf
