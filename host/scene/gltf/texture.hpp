// Reads the images that materials need. In: the index of a glTF texture; out: an alpha texture in
// Scene::textures or a colour texture, which equal uses share, or the mean colour of an emissive
// texture.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/decoded_images.hpp"
#include "scene/gltf/document/document.hpp"

namespace dapple::gltf {

class TextureReader {
 public:
  /// `with_colors`: images of alphas are also read for their colours.
  TextureReader(const Document& document, bool with_colors, Scene& scene)
      : document_(document), scene_(scene), images_(document, with_colors) {}

  /// Sets of which textures alpha or colour will be read, in this order, so that their images are
  /// decoded on all processors.
  void expect(const std::vector<int>& textures);

  /// Returns the index in Scene::textures of a glTF texture's alpha; -1 if all of it is opaque, so
  /// that walls are found to be opaque. Throws Error input, naming `user`, when the image is
  /// missing, corrupt or in a format that dapple cannot read.
  int alpha_texture(int texture, const std::string& user);

  /// Returns the index in Scene::color_textures of a glTF texture. Throws like alpha_texture().
  int color_texture(int texture, const std::string& user);

  /// Returns the mean linear colour of a glTF texture. Throws like alpha_texture().
  [[nodiscard]] V3f mean_color(int texture, const std::string& user);

 private:
  using Key = std::tuple<int, Wrap, Wrap, bool>;  // image, wrap_s, wrap_t, nearest

  /// Calls read(), or throws the Error that it threw before, of `what`: the image may be large.
  template <class Read>
  void read_once(int image, const std::string& what, const Read& read);
  void count_texels(std::uint64_t texels, const std::string& what);

  const Document& document_;
  Scene& scene_;
  DecodedImages images_;
  std::map<Key, int> loaded_, loaded_colors_;
  std::map<int, V3f> means_;            ///< by image
  std::map<int, std::string> refused_;  ///< images that cannot be read, and why
  std::uint64_t texels_ = 0;            ///< of all textures in the scene
};

}  // namespace dapple::gltf
