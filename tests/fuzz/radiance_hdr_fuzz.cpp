// Decodes any bytes as a dome's Radiance HDR image. This gives one texel for each pixel, or an
// Error of kind input.
#include "dapple/error.hpp"
#include "scene/images/radiance_hdr.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const dapple::Environment image = dapple::decode_radiance_hdr({data, size}, "image");
    if (image.radiance.size() != std::size_t{image.width} * image.height) __builtin_trap();
  } catch (const dapple::Error& error) {
    if (error.kind() != dapple::ErrorKind::input) __builtin_trap();
  }
  return 0;
}
