// Decodes any bytes as an image. This gives one alpha for each pixel, or an Error of kind input.
#include "dapple/error.hpp"
#include "scene/images/image.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const dapple::AlphaImage image = dapple::decode_alpha({data, size}, "image");
    if (image.alpha.size() != std::size_t{image.width} * image.height) __builtin_trap();
    dapple::mean_linear_color({data, size}, "image");
  } catch (const dapple::Error& error) {
    if (error.kind() != dapple::ErrorKind::input) __builtin_trap();
  }
  return 0;
}
