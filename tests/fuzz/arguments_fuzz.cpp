// Parses any text as the argument of each option: this gives a value, or an Error of kind usage.
#include <string>

#include "commands/arguments/option_text.hpp"
#include "dapple/error.hpp"
#include "scene/procedural/parameters.hpp"
#include "scene/procedural/procedural.hpp"

namespace {

template <typename Parse>
void try_parse(const Parse& parse) {
  try {
    parse();
  } catch (const dapple::Error& error) {
    if (error.kind() != dapple::ErrorKind::usage) __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  dapple::RenderOptions options;
  try_parse([&] { dapple::parse_vector("--up", text); });
  try_parse([&] { dapple::parse_crop(text); });
  try_parse([&] { dapple::parse_opacity(text); });
  try_parse([&] { dapple::parse_frames(text); });
  try_parse([&] { dapple::parse_estimator(text); });
  try_parse([&] { dapple::parse_passes(text, options); });
  for (const dapple::ProceduralHelp& scene : dapple::procedural_help()) {
    try_parse([&] { dapple::ProceduralParameters(scene, text); });
  }
  return 0;
}
