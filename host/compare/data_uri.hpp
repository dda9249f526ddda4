// Encodes bytes and text for HTML pages. In: bytes, or any text. Out: base64, data URIs, or text
// with entities.
#pragma once

#include <string>
#include <string_view>

namespace dapple {

/// The base64 encoding of RFC 4648, section 4, with padding.
std::string base64(std::string_view bytes);

/// "data:image/png;base64,..." of a PNG file's bytes.
std::string png_data_uri(std::string_view png);

/// `text` with the characters that have a meaning in HTML, also inside quotes, as entities,
/// and as UTF-8: names of files may have other bytes.
std::string escape_html(std::string_view text);

}  // namespace dapple
