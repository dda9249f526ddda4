// Finds, reads and shares images: see texture.hpp.
#include "scene/gltf/texture.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "dapple/error.hpp"
#include "scene/gltf/document/uri.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

/// The extensions for image formats other than PNG, JPEG and WebP.
constexpr const char* kOtherFormats[] = {"KHR_texture_basisu", "EXT_texture_avif",
                                         "MSFT_texture_dds"};

/// The limit of the texels of all textures, alpha and colour. An image's file can be a thousand
/// times smaller than its texels.
constexpr std::uint64_t kMaxTexels = std::uint64_t{1} << 31;

std::string image_name(const Document& document, int image) {
  const ImageSource& source = document.images[static_cast<std::size_t>(image)];
  if (!source.uri.empty() && !is_data_uri(source.uri)) return source.uri;
  if (!source.name.empty()) return source.name;
  return fmt::format("image_{}", image);
}

/// Whether the bytes of an image are in the scene, or in a file that exists.
bool is_there(const Document& document, int image) {
  const ImageSource& source = document.images[static_cast<std::size_t>(image)];
  std::error_code unknown;
  return source.buffer_view >= 0 || is_data_uri(source.uri) ||
         std::filesystem::exists(document.base.folder / percent_decode(source.uri), unknown);
}

/// Returns -1 if there is none that dapple can read.
int find_image(const Document& document, int texture) {
  const auto& given = document.model.textures[static_cast<std::size_t>(texture)];
  const int webp = webp_image(given);
  if (webp >= 0 && (given.source < 0 || is_there(document, webp))) return webp;
  return given.source;
}

int image_of(const Document& document, int texture, const std::string& user) {
  const int image = find_image(document, texture);
  if (image >= 0) return image;
  const auto& given = document.model.textures[static_cast<std::size_t>(texture)];
  for (const char* extension : kOtherFormats) {
    if (!given.extensions.contains(extension)) continue;
    fail(document.file,
         "texture {} of {} exists only as {}, which dapple cannot read; export it as PNG", texture,
         user, extension);
  }
  fail(document.file, "texture {} of {} has no image", texture, user);
}

std::string describe(const Document& document, int image, const std::string& user) {
  return one_line(fmt::format("{}: image {} ({}) of {}", document.file, image,
                              excerpt(image_name(document, image)), user));
}

Wrap wrap_mode(int code) {
  if (code == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp;
  return code == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirror : Wrap::repeat;
}

/// Returns a texture without pixels that has the sampler's modes.
Texture sampled(const Document& document, int texture) {
  Texture result;
  const int index = document.model.textures[static_cast<std::size_t>(texture)].sampler;
  if (index < 0) return result;
  const auto& sampler = document.model.samplers[static_cast<std::size_t>(index)];
  result.wrap_s = wrap_mode(sampler.wrapS);
  result.wrap_t = wrap_mode(sampler.wrapT);
  result.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  return result;
}

}  // namespace

void TextureReader::expect(const std::vector<int>& textures) {
  std::vector<int> images;
  for (const int texture : textures) {
    const int image = find_image(document_, texture);
    if (image >= 0 && std::find(images.begin(), images.end(), image) == images.end())
      images.push_back(image);
  }
  images_.expect(std::move(images));
}

int TextureReader::alpha_texture(int texture, const std::string& user) {
  const int image = image_of(document_, texture, user);
  Texture result = sampled(document_, texture);
  const Key key{image, result.wrap_s, result.wrap_t, result.nearest};
  if (const auto known = loaded_.find(key); known != loaded_.end()) return known->second;
  const std::string what = describe(document_, image, user);
  const ColorImage* content = nullptr;
  read_once(image, what, [&] { content = &images_.get(image, what); });
  const std::vector<std::uint8_t>& alpha = content->alpha;
  count_texels(alpha.size(), what);
  if (std::all_of(alpha.begin(), alpha.end(), [](std::uint8_t a) { return a == 255; })) {
    loaded_.emplace(key, -1);
    return -1;
  }
  result.name = one_line(image_name(document_, image));
  result.width = content->width;
  result.height = content->height;
  result.alpha = alpha;
  const int index = static_cast<int>(scene_.textures.size());
  scene_.textures.push_back(std::move(result));
  loaded_.emplace(key, index);
  return index;
}

void TextureReader::count_texels(std::uint64_t texels, const std::string& what) {
  texels_ += texels;
  if (texels_ <= kMaxTexels) return;
  fail(what, "brings the textures to {} texels (at most {})", grouped(texels_),
       grouped(kMaxTexels));
}

template <class Read>
void TextureReader::read_once(int image, const std::string& what, const Read& read) {
  if (const auto known = refused_.find(image); known != refused_.end())
    throw Error(ErrorKind::input, what + known->second);
  try {
    read();
  } catch (const Error& error) {
    const std::string text = error.what();
    refused_.emplace(image, text.starts_with(what) ? text.substr(what.size()) : ": " + text);
    throw;
  }
}

int TextureReader::color_texture(int texture, const std::string& user) {
  const int image = image_of(document_, texture, user);
  const Texture modes = sampled(document_, texture);
  const Key key{image, modes.wrap_s, modes.wrap_t, modes.nearest};
  if (const auto known = loaded_colors_.find(key); known != loaded_colors_.end())
    return known->second;
  const std::string what = describe(document_, image, user);
  ColorImage content;
  read_once(image, what, [&] { content = images_.take(image, what); });
  count_texels(content.alpha.size(), what);
  const int index = static_cast<int>(scene_.color_textures.size());
  scene_.color_textures.push_back({one_line(image_name(document_, image)), content.width,
                                   content.height, std::move(content.rgb), std::move(content.alpha),
                                   modes.wrap_s, modes.wrap_t, modes.nearest});
  loaded_colors_.emplace(key, index);
  return index;
}

V3f TextureReader::mean_color(int texture, const std::string& user) {
  const int image = image_of(document_, texture, user);
  if (const auto known = means_.find(image); known != means_.end()) return known->second;
  const std::string what = describe(document_, image, user);
  V3f mean(0, 0, 0);
  read_once(image, what,
            [&] { mean = mean_linear_color(read_image(document_, image, what).bytes, what); });
  means_.emplace(image, mean);
  return mean;
}

}  // namespace dapple::gltf
