// Writes films as OpenEXR files, and reads them again. In: a Film, or any EXR file that
// host/files/exr_reader.hpp reads. Out: a file of one part or several, or a Film.
// OpenEXR's threads are a setting of the whole process, which only a program may change:
// use_exr_threads().
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "dapple/error.hpp"
#include "dapple/film.hpp"
#include "files/exr_reader.hpp"
#include "files/output_file.hpp"
#include "film/exr/exr_output.hpp"
#include "film/exr/exr_parts.hpp"
#include "film/exr/exr_writer_header.hpp"
#include "film/film_defect.hpp"

namespace dapple {
namespace {

using Imath::Box2i;

Imf::Compression imf_compression(ExrCompression compression) {
  switch (compression) {
    case ExrCompression::none:
      return Imf::NO_COMPRESSION;
    case ExrCompression::zips:
      return Imf::ZIPS_COMPRESSION;
    case ExrCompression::piz:
      return Imf::PIZ_COMPRESSION;
    case ExrCompression::dwaa:
      return Imf::DWAA_COMPRESSION;
    default:
      return Imf::ZIP_COMPRESSION;
  }
}

Imf::Header header_of(const Film& film, const ExrPart& part) {
  Imf::Header header = exr_header(film, imf_compression(part.compression));
  for (std::size_t i = 0; i < part.planes.size(); ++i) {
    const Imf::PixelType type = part.half[i] ? Imf::HALF : Imf::FLOAT;
    header.channels().insert(part.planes[i]->channel, Imf::Channel(type));
  }
  // The Color Interop Forum's name of the linear space with BT.709 primaries, a standard attribute
  // since OpenEXR 3.4; chromaticities say the same to older readers.
  header.insert("colorInteropID", Imf::StringAttribute(part.color ? "lin_rec709_scene" : "data"));
  Imf::addChromaticities(header, Imf::Chromaticities());
  return header;
}

std::vector<Imf::Header> headers_of(const Film& film, const std::vector<ExrPart>& parts,
                                    bool multipart) {
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : parts) {
    headers.push_back(header_of(film, part));
    if (!multipart) continue;
    headers.back().setName(part.name);
    headers.back().setType(Imf::SCANLINEIMAGE);
  }
  insert_metadata(headers[0], film.metadata);
  // Readers look for the attributes of Cryptomattes in the first part or in that of their layers.
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0 && !parts[i].name.starts_with("crypto_")) continue;
    for (const auto& [name, value] : film.metadata.attributes)
      headers[i].insert(name, Imf::StringAttribute(value));
  }
  return headers;
}

/// The largest 16-bit float. DWAA codes colours as such, with errors that would pass it.
constexpr float kLargestHalf = 65504, kLargestOfDwaa = 60000;

/// Finite values beyond the largest one become it.
float limited(float value, float largest) {
  return std::isfinite(value) ? std::clamp(value, -largest, largest) : value;
}

/// Writes one part. `Out` is OpenEXR's OutputFile or OutputPart.
template <class Out>
void write_part(Out& out, const ExrPart& part, const PixelRect& data_window) {
  Imf::FrameBuffer buffer;
  const Box2i window = exr_window(data_window);
  std::vector<std::vector<half>> halves;
  std::vector<std::vector<float>> floats;
  const bool lossy = part.compression == ExrCompression::dwaa;
  const float largest = lossy ? kLargestOfDwaa : kLargestHalf;
  const auto limit = [&](float value) { return limited(value, largest); };
  for (std::size_t i = 0; i < part.planes.size(); ++i) {
    const Plane& plane = *part.planes[i];
    const void* values = plane.pixels.data();
    if (part.half[i]) {
      halves.emplace_back(plane.pixels.size());
      std::transform(plane.pixels.begin(), plane.pixels.end(), halves.back().begin(),
                     [&](float value) { return half(limit(value)); });
      values = halves.back().data();
    } else if (lossy) {
      floats.emplace_back(plane.pixels.size());
      std::transform(plane.pixels.begin(), plane.pixels.end(), floats.back().begin(), limit);
      values = floats.back().data();
    }
    buffer.insert(plane.channel,
                  Imf::Slice::Make(part.half[i] ? Imf::HALF : Imf::FLOAT, values, window));
  }
  out.setFrameBuffer(buffer);
  out.writePixels(data_window.height());
}

void encode(const Film& film, const std::vector<ExrPart>& parts, bool multipart,
            PendingFile& file) {
  PendingStream stream(file);
  const std::vector<Imf::Header> headers = headers_of(film, parts, multipart);
  if (!multipart) {
    Imf::OutputFile out(stream, headers[0], Imf::globalThreadCount());
    write_part(out, parts[0], film.data_window);
    return;
  }
  Imf::MultiPartOutputFile out(stream, headers.data(), static_cast<int>(headers.size()), false,
                               Imf::globalThreadCount());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Imf::OutputPart part(out, static_cast<int>(i));
    write_part(part, parts[i], film.data_window);
  }
}

std::string take(std::vector<std::pair<std::string, std::string>>& texts, const std::string& name) {
  const auto found = std::find_if(texts.begin(), texts.end(),
                                  [&](const auto& entry) { return entry.first == name; });
  if (found == texts.end()) return {};
  std::string value = std::move(found->second);
  texts.erase(found);
  return value;
}

FilmMetadata read_metadata(const Imf::Header& header) {
  FilmMetadata metadata;
  if (Imf::hasWorldToCamera(header)) metadata.world_to_camera = Imf::worldToCamera(header);
  if (Imf::hasWorldToNDC(header)) metadata.world_to_ndc = Imf::worldToNDC(header);
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute());
    if (text == nullptr) continue;
    if (name.starts_with(kExrPrefix))
      metadata.settings.emplace_back(name.substr(kExrPrefix.size()), text->value());
    if (name.starts_with("cryptomatte/")) metadata.attributes.emplace_back(name, text->value());
  }
  metadata.scene = take(metadata.settings, "scene");
  metadata.device = take(metadata.settings, "device");
  metadata.version = take(metadata.settings, "version");
  const std::string seed = take(metadata.settings, "seed");
  std::from_chars(seed.data(), seed.data() + seed.size(), metadata.seed);
  const auto* samples = header.findTypedAttribute<Imf::IntAttribute>(exr_attribute("samples"));
  if (samples != nullptr) metadata.samples = samples->value();
  return metadata;
}

Film film_without_pixels(const Imf::Header& header) {
  const Box2i& display = header.displayWindow();
  const Box2i& data = header.dataWindow();
  Film film;
  film.width = display.max.x - display.min.x + 1;
  film.height = display.max.y - display.min.y + 1;
  film.data_window = {data.min.x - display.min.x, data.min.y - display.min.y,
                      data.max.x - display.min.x, data.max.y - display.min.y};
  film.metadata = read_metadata(header);
  return film;
}

}  // namespace

void use_exr_threads(int count) { Imf::setGlobalThreadCount(count); }

void write_exr(const Film& film, const std::string& path, const ExrFormat& format) {
  write_exr(film, path, format, Durable::yes);
}

void write_exr(const Film& film, const std::string& path, const ExrFormat& format,
               Durable durable) {
  PendingFile file(path);
  write_exr(film, file, format, durable);
  file.commit();
}

void write_exr(const Film& film, PendingFile& file, const ExrFormat& format, Durable durable) {
  validate(format);
  const std::string reason = film_defect(film);
  if (!reason.empty()) file.fail(reason);
  const std::vector<ExrPart> parts = exr_parts(film, format);
  try {
    encode(film, parts, format.multipart, file);
    file.close(durable);
    if (durable == Durable::yes) file.verify();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& problem) {
    file.fail(problem.what());
  }
}

Film read_exr(const std::string& path) {
  ExrFile file(path);
  Film film = film_without_pixels(file.header());
  ExrImage image = file.image();
  for (auto& [channel, pixels] : image.channels)
    film.planes.push_back({channel, std::move(pixels)});
  return film;
}

FilmMetadata read_exr_metadata(const std::string& path) {
  return film_without_pixels(ExrFile(path).header()).metadata;
}

}  // namespace dapple
