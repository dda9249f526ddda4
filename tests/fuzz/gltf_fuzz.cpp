// Reads any bytes as a scene, at rest and at a time, and merges its meshes. This gives a scene, or
// an Error of kind input.
#include <optional>

#include "dapple/error.hpp"
#include "dapple/moving_scene.hpp"
#include "fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
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
