// Reads EXR files: images of dome lights, and films. In: a path. Out: channels of floats, or an
// Error. Only this file and film/exr_writer.cpp, which writes films, use OpenEXR.
#pragma once

#include <ImfForward.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace dapple {

/// Row-major over the data window, top row first.
struct ExrImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::map<std::string, std::vector<float>> channels;
};

/// Called with the header, for what ExrImage does not contain.
using SeeExrHeader = std::function<void(const Imf::Header&)>;

/// Reads any EXR, scanline or tiled, without subsampling or deep data and of at most 2^28 pixels;
/// HALF and UINT become float. Parts must have one data window; the header is that of the first.
/// Throws Error input.
ExrImage read_exr_image(const std::string& path, const SeeExrHeader& see_header = {});

}  // namespace dapple
