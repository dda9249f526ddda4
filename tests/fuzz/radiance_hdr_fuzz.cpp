// Decodes any bytes as a dome's Radiance HDR image. This gives as many pixels as its header says,
// the same by halves as at once, or an Error of kind input.
#include "dapple/error.hpp"
#include "scene/images/radiance_hdr.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const dapple::RadianceImage image({data, size}, "image");
    const std::uint32_t height = image.height();
    const std::vector<dapple::V3f> pixels = image.rows(0, height);
    if (pixels.size() != std::size_t{image.width()} * height) __builtin_trap();
    if (height < 2) return 0;
    std::vector<dapple::V3f> halves = image.rows(0, height / 2);
    const std::vector<dapple::V3f> second = image.rows(height / 2, height - height / 2);
    halves.insert(halves.end(), second.begin(), second.end());
    if (halves != pixels) __builtin_trap();
  } catch (const dapple::Error& error) {
    if (error.kind() != dapple::ErrorKind::input) __builtin_trap();
  }
  return 0;
}
