// Any bytes as a scene: an Error of kind input, or triangles that a BVH can be built over.
#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const dapple::fuzz::InputFile file("scene.glb");
  try {
    dapple::Scene scene = dapple::load_scene(file.fill(data, size));
    dapple::merge_single_instances(scene);
  } catch (const dapple::Error& error) {
    if (error.kind() != dapple::ErrorKind::input) __builtin_trap();
  }
  return 0;
}
