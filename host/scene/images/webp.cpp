// Only this file uses libwebp: see webp.hpp.
#include "scene/images/webp.hpp"

#include <webp/decode.h>

namespace dapple {

WebpImage::WebpImage(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK) {
    defect_ = "is corrupt (its WebP header)";
    return;
  }
  if (features.has_animation != 0) defect_ = "is an animation; textures are still images";
  width_ = static_cast<std::uint32_t>(features.width);
  height_ = static_cast<std::uint32_t>(features.height);
}

std::uint8_t* WebpImage::decode_rgba() const {
  int width = 0, height = 0;
  return WebPDecodeRGBA(bytes_.data(), bytes_.size(), &width, &height);
}

void WebpImage::free(void* pixels) { WebPFree(pixels); }

}  // namespace dapple
