// Decodes the images of a glTF file, several at a time. In: indices of images, in the order in
// which materials will ask for them. Out: the content of each.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/gltf/document/document.hpp"
#include "scene/images/image.hpp"

namespace dapple::gltf {

/// The bytes of an image's file.
struct ImageBytes {
  Bytes owned;  ///< empty when the bytes are in a buffer
  std::span<const std::uint8_t> bytes;
};

/// Throws Error input, which begins with `what`, if they are missing.
ImageBytes read_image(const Document& document, int image, const std::string& what);

class DecodedImages {
 public:
  /// `with_colors`: colours are decoded, too, not alphas alone.
  DecodedImages(const Document& document, bool with_colors)
      : document_(document), with_colors_(with_colors) {}

  /// Sets which images get() will be asked for, in this order.
  void expect(std::vector<int> images) { expected_ = std::move(images); }

  /// The content of an image; `rgb` is empty without colours. It is kept until another one is asked
  /// for. Decodes some of those that are expected next on the other processors. Throws Error input,
  /// which begins with `what`, when the image is missing, corrupt or in a format that dapple cannot
  /// read.
  const ColorImage& get(int image, const std::string& what);
  /// The same, but keeps nothing.
  ColorImage take(int image, const std::string& what);

 private:
  [[nodiscard]] ColorImage decode(std::span<const std::uint8_t> bytes,
                                  const std::string& what) const;
  /// Decodes `image` and those after it into ahead_, but for what cannot be read.
  void decode_ahead(int image);

  const Document& document_;
  bool with_colors_;
  std::vector<int> expected_;
  std::map<int, ColorImage> ahead_;  ///< by image
  int last_image_ = -1;              ///< whose content is `last_`
  ColorImage last_;
};

}  // namespace dapple::gltf
