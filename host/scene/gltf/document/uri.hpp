// URIs of buffers and images. In: a URI; out: the bytes of a `data:` URI, or the path of a relative
// one, which must lie inside the scene's folder unless that is allowed. Other URIs are errors.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/regular_file.hpp"

namespace dapple::gltf {

bool is_data_uri(std::string_view uri);

/// Whether a URI begins with a scheme such as "http:" (RFC 3986, section 3.1).
bool has_scheme(std::string_view uri);

/// Returns the bytes of a `data:` URI, base64 or percent-encoded. Throws Error input when it is
/// malformed; the message begins with `what`.
Bytes decode_data_uri(std::string_view uri, const std::string& what);

/// Returns "a b" for "a%20b". A % without two hexadecimal digits after it stays as it is, because
/// exporters do not encode file names like "100%.png".
std::string percent_decode(std::string_view text);

/// A file name as a relative URI: all but unreserved characters (RFC 3986) as %XX.
std::string percent_encode(std::string_view name);

/// A folder, and whether URIs may lead out of it.
struct UriBase {
  std::filesystem::path folder;
  bool allow_outside = false;
};

/// Returns the path of the file that a relative URI names; the file need not exist. Throws Error
/// input when the URI is empty, has a scheme, holds a NUL, is too long for a file name, or leads
/// out of the folder (as an absolute path, with "..", or through symbolic links) although
/// base.allow_outside is false.
std::filesystem::path resolve_uri(const UriBase& base, std::string_view uri,
                                  const std::string& what);

/// Returns the media type of a `data:` URI, such as "image/png"; often empty.
std::string_view data_media_type(std::string_view uri);

}  // namespace dapple::gltf
