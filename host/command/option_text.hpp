// Option values as typed, to what they mean. All throw Error usage naming the flag.
#pragma once

#include <string>
#include <utility>

#include "dapple/options.hpp"

namespace dapple {

/// "1,2.5,-3"
V3f parse_vector(const std::string& flag, const std::string& text);
/// "X0,Y0,X1,Y1", whole numbers
PixelRect parse_crop(const std::string& text);
/// "leaf=0.85"; the name may contain '='
std::pair<std::string, float> parse_opacity(const std::string& text);
/// "exact", "prefiltered" or "packet"
Estimator parse_estimator(const std::string& text);
/// "auto", "alone", "neighbours" or "point"
Company parse_company(const std::string& text);
/// "ao", "light", "ao,light"
void parse_passes(const std::string& text, RenderOptions& options);

/// "30", "30s", "5m", "1h" to seconds, above 0
double parse_seconds(const std::string& flag, const std::string& text);

}  // namespace dapple
