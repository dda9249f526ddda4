// URIs of buffers and images: `data:` ones are decoded, relative ones become paths that
// stay inside the scene's folder unless that is waived, everything else is refused.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/gltf/file.hpp"

namespace dapple::gltf {

bool is_data_uri(std::string_view uri);

/// RFC 3986: whether the uri begins as "http:" does.
bool has_scheme(std::string_view uri);

/// The bytes of a `data:` URI, base64 or percent-encoded. Throws Error input, the
/// message beginning with `what`, when it is malformed.
Bytes decode_data_uri(std::string_view uri, const std::string& what);

/// "a%20b" as "a b"; a % that no two hexadecimal digits follow stays as it is, because
/// exporters leave file names like "100%.png" unencoded.
std::string percent_decode(std::string_view text);

/// A folder, and whether URIs may lead out of it.
struct UriBase {
  std::filesystem::path folder;
  bool allow_outside = false;
};

/// The file that a relative URI means, existing or not. Throws Error input when the URI has a
/// scheme, holds a NUL, is too long for a file name or, unless that is allowed, is absolute or
/// leads out of the folder (through symbolic links too).
std::filesystem::path resolve_uri(const UriBase& base, std::string_view uri,
                                  const std::string& what);

/// What a `data:` URI says its content is, such as "image/png"; often empty.
std::string_view data_media_type(std::string_view uri);

}  // namespace dapple::gltf
