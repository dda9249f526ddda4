// URIs of buffers and images: `data:` ones are decoded, relative ones become paths that
// stay inside the scene's folder, everything else is refused.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/gltf/file.hpp"

namespace dapple::gltf {

bool is_data_uri(std::string_view uri);

/// The bytes of a `data:` URI, base64 or percent-encoded. Throws Error input, the
/// message beginning with `what`, when it is malformed.
Bytes decode_data_uri(std::string_view uri, const std::string& what);

/// "a%20b" as "a b"; a % that no two hexadecimal digits follow stays as it is, because
/// exporters leave file names like "100%.png" unencoded.
std::string percent_decode(std::string_view text);

/// The file that a relative URI means. Throws Error input when the URI has a scheme, is
/// absolute, or leads out of `folder` (through symbolic links too).
std::filesystem::path resolve_uri(const std::filesystem::path& folder, std::string_view uri,
                                  const std::string& what);

}  // namespace dapple::gltf
