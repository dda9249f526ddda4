// Parses option values. In: text. Out: values. Every function throws Error usage, naming the flag.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "dapple/film.hpp"
#include "dapple/options.hpp"

namespace dapple {

/// "1,2.5,-3"
V3f parse_vector(const std::string& flag, const std::string& text);
/// "X0,Y0,X1,Y1", whole numbers
PixelRect parse_crop(const std::string& text);
/// "2%" or "2" to 0.02; below 1 a number without % is a share, as 0.02
float parse_share(const std::string& flag, const std::string& text);
/// "leaf=0.85"; the name may contain '='
std::pair<std::string, float> parse_opacity(const std::string& text);
/// "exact" or "prefiltered"
Estimator parse_estimator(const std::string& text);
/// "auto" or stops; "sky", "none" or "R,G,B"
PngOptions parse_png_options(const std::string& exposure, const std::string& background);
/// "shading" or "geometric"
Normals parse_normals(const std::string& text);
/// "auto", "none", "pixel", "point" or "scalar"
Packets parse_packets(const std::string& text);
/// "object", "material" or both; empty: none
Cryptomattes parse_cryptomattes(const std::string& text);
/// "zip", "zips", "piz", "dwaa" or "none"
ExrCompression parse_compression(const std::string& text);
/// "ao,N"; empty: none
std::vector<std::string> parse_names(const std::string& flag, const std::string& text);
/// "ao", "light", "ao,light"
void parse_passes(const std::string& text, RenderOptions& options);

/// Frame numbers first, first + step, ... up to last.
struct FrameRange {
  std::int64_t first = 0, last = 0, step = 1;

  [[nodiscard]] std::int64_t count() const { return (last - first) / step + 1; }
};

/// "1-24", "1-100:10", "7": not negative, at most 100,000 of them
FrameRange parse_frames(const std::string& text);

/// "2/8"
Shard parse_shard(const std::string& text);

/// "-0.25,0.25": two finite numbers
std::pair<double, double> parse_shutter(const std::string& text);

/// "30", "30s", "5m", "1h" to seconds, above 0
double parse_seconds(const std::string& flag, const std::string& text);

}  // namespace dapple
