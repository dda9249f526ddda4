// Reads any bytes as a lights file. This gives lights with finite numbers, or an Error of kind
// input.
#include <cmath>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const dapple::fuzz::InputFile file("lights.json");
  try {
    for (const dapple::Light& light : dapple::load_lights(file.fill(data, size))) {
      if (!std::isfinite(light.radiance.length() + light.position.length())) __builtin_trap();
    }
  } catch (const dapple::Error& error) {
    if (error.kind() != dapple::ErrorKind::input) __builtin_trap();
  }
  return 0;
}
