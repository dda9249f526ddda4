// Bytes as text that an HTML page can hold.
#pragma once

#include <string>
#include <string_view>

namespace dapple {

/// RFC 4648, section 4, with padding.
std::string base64(std::string_view bytes);

/// "data:image/png;base64,..." of a PNG file's bytes.
std::string png_data_uri(std::string_view png);

/// `text` with the characters that mean something in HTML, inside quotes or out, as entities.
std::string escape_html(std::string_view text);

}  // namespace dapple
