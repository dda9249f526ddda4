// Reads any bytes as a scene, at rest and at a time, and merges its meshes. This gives a scene, or
// an Error of kind input. Inputs with a whole number of seven digits or more are left out: a count
// of some million instances is legal, and takes seconds. The corpus of tests/corpus has such
// counts.
#include <algorithm>
#include <cctype>
#include <optional>

#include "dapple/error.hpp"
#include "dapple/moving_scene.hpp"
#include "fuzz/input_file.hpp"

namespace {

constexpr int kMaxDigits = 6;

bool has_long_whole_number(const std::uint8_t* data, std::size_t size) {
  int digits = 0;
  bool is_fraction = false;
  return std::any_of(data, data + size, [&](std::uint8_t byte) {
    if (std::isdigit(byte) == 0) {
      digits = 0;
      is_fraction = byte == '.';
      return false;
    }
    return ++digits > kMaxDigits && !is_fraction;
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (has_long_whole_number(data, size)) return 0;
  static const dapple::fuzz::InputFile file("scene.glb");
  dapple::SceneOptions options;
  options.line_radius = 0.01f;
  const std::string& path = file.fill(data, size);
  for (const std::optional<double> seconds : {std::optional<double>(), std::optional(0.3)}) {
    options.time = seconds;
    try {
      dapple::Scene scene = dapple::load_scene(path, options);
      dapple::merge_single_instances(scene);
    } catch (const dapple::Error& error) {
      if (error.kind() != dapple::ErrorKind::input) __builtin_trap();
    }
  }
  return 0;
}
