// Names of images that are written. Outputs have the right format whatever their names are, but the
// names of other formats would deceive.
#pragma once

#include <string>

namespace dapple {

/// Throws Error usage when `path` is named as a format other than OpenEXR.
void check_exr_name(const char* flag, const std::string& path);

/// Throws Error usage when `path`, the value of --png, is named as a format other than PNG.
void check_png_name(const std::string& path);

}  // namespace dapple
