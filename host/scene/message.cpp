// Formats the messages of the readers of scenes: see message.hpp.
#include "scene/message.hpp"

namespace dapple {
namespace {

/// Limits in bytes, because names in a file may be megabytes long.
constexpr std::size_t kMaxExcerptLength = 120;
constexpr std::size_t kMaxMessageLength = 1200;

/// Returns the first `bytes` of `text` and "...", without an incomplete UTF-8 character at the end.
std::string shorten(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return std::string(text);
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0u) == 0x80u) --bytes;
  return std::string(text.substr(0, bytes)) + "...";
}

bool is_control(unsigned char c) { return c < 0x20 || c == 0x7f; }

/// Whether U+0080 to U+009F begins at `at`: terminals interpret these like escape sequences.
bool is_c1_control(std::string_view text, std::size_t at) {
  return at + 1 < text.size() && text[at] == '\xc2' &&
         static_cast<unsigned char>(text[at + 1]) < 0xa0;
}

}  // namespace

std::string one_line(std::string_view text) {
  std::string line;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool two = is_c1_control(text, i);
    line.push_back(two || is_control(static_cast<unsigned char>(text[i])) ? ' ' : text[i]);
    if (two) ++i;
  }
  return line;
}

std::string excerpt(std::string_view text) { return shorten(text, kMaxExcerptLength); }

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
  return fmt::format("{} {} (\"{}\")", kind, index, one_line(excerpt(name)));
}

void fail_with(const std::string& file, const std::string& message) {
  throw Error(ErrorKind::input, one_line(file + ": " + shorten(message, kMaxMessageLength)));
}

}  // namespace dapple
