#include "film/exr/exr_writer_header.hpp"

#include <ImfIntAttribute.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "files/utf8.hpp"

namespace dapple {
namespace {

using Imath::Box2i;
using Imath::V2i;

constexpr std::size_t kMaxAttributeNameLength = 255;

/// Names of files may have other bytes than UTF-8, which viewers and Python refuse.
void insert_text(Imf::Header& header, const std::string& name, const std::string& value) {
  header.insert(exr_attribute(name), Imf::StringAttribute(utf8_of(value)));
}

// Settings of these names are not written: the metadata has the values that were used.
bool is_reserved(const std::string& setting) {
  constexpr std::array<std::string_view, 5> kReserved = {"scene", "device", "version", "seed",
                                                         "samples"};
  return std::find(kReserved.begin(), kReserved.end(), setting) != kReserved.end();
}

}  // namespace

std::string exr_attribute(const std::string& name) {
  return (std::string(kExrPrefix) + name).substr(0, kMaxAttributeNameLength);
}

Box2i exr_window(const PixelRect& rect) { return {V2i(rect.x0, rect.y0), V2i(rect.x1, rect.y1)}; }

namespace {

/// Width of the whole image at the distance 1 from the camera, as OpenEXR has it, or in metres if
/// it is orthographic: x is scaled by its inverse, between the camera's space and [0,1].
float screen_window_width(const FilmMetadata& metadata) {
  const float scale = (metadata.world_to_camera.inverse() * metadata.world_to_ndc)[0][0];
  return std::isfinite(1 / scale) ? std::fabs(1 / scale) : 1.0f;
}

}  // namespace

Imf::Header exr_header(const Film& film, Imf::Compression compression) {
  Imf::Header header(Box2i(V2i(0, 0), V2i(film.width - 1, film.height - 1)),
                     exr_window(film.data_window), 1.0f, Imath::V2f(0, 0),
                     screen_window_width(film.metadata), Imf::INCREASING_Y, compression);
  if (compression == Imf::ZIP_COMPRESSION || compression == Imf::ZIPS_COMPRESSION)
    header.zipCompressionLevel() = 1;  // not 4: experiment 804
  return header;
}

void insert_metadata(Imf::Header& header, const FilmMetadata& metadata) {
  Imf::addWorldToCamera(header, metadata.world_to_camera);
  Imf::addWorldToNDC(header, metadata.world_to_ndc);
  for (const auto& [name, value] : metadata.settings) {
    if (!is_reserved(name)) insert_text(header, name, value);
  }
  insert_text(header, "scene", metadata.scene);
  insert_text(header, "device", metadata.device);
  insert_text(header, "version", metadata.version);
  insert_text(header, "seed", std::to_string(metadata.seed));  // EXR's integers are signed
  header.insert(exr_attribute("samples"), Imf::IntAttribute(metadata.samples));
}

}  // namespace dapple
