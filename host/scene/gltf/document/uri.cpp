// Decodes URIs and checks that paths stay inside a folder: see uri.hpp.
#include "scene/gltf/document/uri.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

namespace fs = std::filesystem;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// The value of every base64 character, -1 for other characters. The URL-safe alphabet is accepted
/// too.
constexpr std::array<std::int8_t, 256> kBase64 = [] {
  std::array<std::int8_t, 256> table{};
  table.fill(-1);
  for (std::size_t i = 0; i < 26; ++i) table['A' + i] = static_cast<std::int8_t>(i);
  for (std::size_t i = 0; i < 26; ++i) table['a' + i] = static_cast<std::int8_t>(26 + i);
  for (std::size_t i = 0; i < 10; ++i) table['0' + i] = static_cast<std::int8_t>(52 + i);
  table['+'] = table['-'] = 62;
  table['/'] = table['_'] = 63;
  return table;
}();

/// Line breaks and blanks, which some encoders write, count for nothing.
Bytes decode_base64(std::string_view text, const std::string& what) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const auto trim = [&] {
    while (!text.empty() && kBlanks.find(text.back()) != std::string_view::npos)
      text.remove_suffix(1);
  };
  trim();
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  trim();
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    if (kBlanks.find(c) != std::string_view::npos) continue;
    const std::int8_t value = kBase64[static_cast<unsigned char>(c)];
    if (value < 0) fail(what, "its data: URI holds a character that is not base64");
    bits = (bits << 6) | static_cast<std::uint32_t>(value);
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes.push_back(static_cast<std::uint8_t>((bits >> bit_count) & 0xffu));
  }
  if (bit_count == 6) fail(what, "its data: URI is cut off (a lone base64 digit at the end)");
  return bytes;
}

/// Names of parameters have no case (RFC 2045).
bool has_base64(std::string_view head) {
  constexpr std::string_view kEnd = ";base64";
  return head.size() >= kEnd.size() &&
         std::equal(kEnd.begin(), kEnd.end(), head.end() - kEnd.size(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

/// Linux's limits in bytes: no file can have a longer name or path.
constexpr std::size_t kMaxNameLength = 255;
constexpr std::size_t kMaxPathLength = 4095;

void check_length(const fs::path& file, const std::string& what) {
  bool sound = file.native().size() <= kMaxPathLength;
  for (const fs::path& name : file) sound = sound && name.native().size() <= kMaxNameLength;
  if (!sound)
    fail(what, "its uri \"{}\" is longer than a file's name can be", excerpt(file.native()));
}

/// Returns an absolute path without symbolic links. The path is made absolute first, because
/// weakly_canonical() leaves a relative path relative when it does not exist.
fs::path whole_path(const fs::path& path, std::error_code& error) {
  const fs::path absolute = fs::absolute(path.empty() ? fs::path(".") : path, error);
  return error ? absolute : fs::weakly_canonical(absolute, error);
}

void check_inside(const fs::path& folder, const fs::path& file, std::string_view uri,
                  const std::string& what) {
  std::error_code error;
  const fs::path root = whole_path(folder, error);
  const fs::path whole = error ? fs::path() : whole_path(file, error);
  if (error) fail(what, "its uri \"{}\" leads nowhere ({})", excerpt(uri), error.message());
  const fs::path inside = whole.lexically_relative(root);
  if (!inside.empty() && *inside.begin() != "..") return;
  fail(what, "its uri \"{}\" leads out of the scene's folder; --allow-outside lets it",
       excerpt(uri));
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

// A scheme is a letter, then letters, digits, '+', '-' or '.', before the first ':'.
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  if (!std::isalpha(static_cast<unsigned char>(uri[0]))) return false;
  return std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '-' || c == '.';
  });
}

std::string percent_decode(std::string_view text) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 &&
                        hex_digit(text[i + 2]) >= 0;
    if (!escape) {
      decoded.push_back(text[i]);
      continue;
    }
    decoded.push_back(static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2])));
    i += 2;
  }
  return decoded;
}

std::string percent_encode(std::string_view name) {
  std::string text;
  for (const char c : name) {
    const bool unreserved = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                            (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '_' || c == '~';
    if (unreserved)
      text += c;
    else
      text += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return text;
}

Bytes decode_data_uri(std::string_view uri, const std::string& what) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) fail(what, "its data: URI has no comma");
  const std::string_view payload = uri.substr(comma + 1);
  if (has_base64(uri.substr(0, comma))) return decode_base64(payload, what);
  const std::string text = percent_decode(payload);
  return Bytes(text.begin(), text.end());
}

std::string_view data_media_type(std::string_view uri) {
  uri.remove_prefix(std::string_view("data:").size());
  return uri.substr(0, uri.find_first_of(";,"));
}

fs::path resolve_uri(const UriBase& base, std::string_view uri, const std::string& what) {
  if (uri.empty()) fail(what, "has an empty uri");
  if (has_scheme(uri)) {
    fail(what, "its uri \"{}\" is not a relative path; dapple reads only local files",
         excerpt(uri));
  }
  const std::string decoded = percent_decode(uri);
  if (decoded.find('\0') != std::string::npos) fail(what, "its uri holds a NUL character");
  fs::path file = base.folder / decoded;
  check_length(file, what);
  if (!base.allow_outside) check_inside(base.folder, file, uri, what);
  return file;
}

}  // namespace dapple::gltf
