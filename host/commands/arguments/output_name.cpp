#include "commands/arguments/output_name.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Whether `path` ends in `format`, or in a format that dapple does not write.
bool is_named_as(const std::string& path, const char* format) {
  std::string name = path;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto ends = [&](const char* suffix) { return name.ends_with(suffix); };
  constexpr const char* kOthers[] = {".jpg", ".jpeg", ".tif", ".tiff", ".hdr", ".json"};
  return ends(format) || std::any_of(std::begin(kOthers), std::end(kOthers), ends);
}

}  // namespace

void check_exr_name(const char* flag, const std::string& path) {
  if (is_named_as(path, ".png"))
    throw Error(ErrorKind::usage,
                fmt::format("{} is {}, but images are OpenEXR files (.exr); --png FILE "
                            "writes a preview beside it",
                            flag, path));
}

void check_png_name(const std::string& path) {
  if (is_named_as(path, ".exr"))
    throw Error(ErrorKind::usage,
                fmt::format("--png is {}, but previews are PNG files (.png)", path));
}

}  // namespace dapple
