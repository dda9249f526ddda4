// EXR files as channels of floats, whatever they are of: the images of domes and films are read
// here. With film/exr.cpp, which writes films, the only place that knows OpenEXR.
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

/// For what else a header holds.
using SeeExrHeader = std::function<void(const Imf::Header&)>;

/// Reads any single-part EXR, scanline or tiled, without subsampling and of at most 2^28 pixels;
/// HALF and UINT become float. Throws Error input.
ExrImage read_exr_image(const std::string& path, const SeeExrHeader& see_header = {});

using ExrRows = std::vector<std::vector<float>>;  ///< one vector a channel

/// Some rows at a time, from the top to the bottom. Throws OpenEXR's exceptions.
void for_each_strip(Imf::InputFile& file, const std::vector<std::string>& channels,
                    const std::function<void(std::size_t first_pixel, const ExrRows& rows)>& visit);

}  // namespace dapple
