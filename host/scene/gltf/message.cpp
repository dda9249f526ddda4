// Wording of the glTF reader's messages: see message.hpp.
#include "scene/gltf/message.hpp"

namespace dapple::gltf {

std::string one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return line;
}

std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t at = digits.size(); at > 3;) {
    at -= 3;
    digits.insert(at, 1, ',');
  }
  return digits;
}

std::string element(std::string_view kind, std::size_t index, std::string_view name) {
  if (name.empty()) return fmt::format("{} {}", kind, index);
  return fmt::format("{} {} (\"{}\")", kind, index, name);
}

}  // namespace dapple::gltf
