// Writes films as OpenEXR files, and reads them again. In: a Film, or any EXR file that
// host/files/exr_reader.hpp reads. Out: a verified file, or a Film. OpenEXR's threads are a setting
// of the whole process, which only a program may change: use_exr_threads().
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "dapple/error.hpp"
#include "dapple/film.hpp"
#include "files/exr_reader.hpp"
#include "files/output_file.hpp"
#include "film/exr_output.hpp"
#include "film/film_defect.hpp"

namespace dapple {
namespace {

using Imath::Box2i;
using Imath::V2i;

constexpr std::size_t kMaxAttributeNameLength = 255;
constexpr std::string_view kPrefix = "dapple:";

Box2i window_of(const PixelRect& rect) { return {V2i(rect.x0, rect.y0), V2i(rect.x1, rect.y1)}; }

std::string attribute_name(const std::string& name) {
  return (std::string(kPrefix) + name).substr(0, kMaxAttributeNameLength);
}

void insert_text(Imf::Header& header, const std::string& name, const std::string& value) {
  header.insert(attribute_name(name), Imf::StringAttribute(value));
}

// Settings of these names are not written: the metadata has the values that were used.
bool is_reserved(const std::string& setting) {
  constexpr std::array<std::string_view, 5> kReserved = {"scene", "device", "version", "seed",
                                                         "samples"};
  return std::find(kReserved.begin(), kReserved.end(), setting) != kReserved.end();
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
  header.insert(attribute_name("samples"), Imf::IntAttribute(metadata.samples));
}

Imf::Header header_of(const Film& film) {
  Imf::Header header(Box2i(V2i(0, 0), V2i(film.width - 1, film.height - 1)),
                     window_of(film.data_window), 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y,
                     Imf::ZIP_COMPRESSION);
  header.zipCompressionLevel() = 1;  // not 4: experiment 804
  for (const Plane& plane : film.planes) {
    header.channels().insert(plane.channel, Imf::Channel(Imf::FLOAT));
  }
  insert_metadata(header, film.metadata);
  return header;
}

class PendingStream final : public Imf::OStream {
 public:
  explicit PendingStream(PendingFile& file)
      : Imf::OStream(file.temporary_path().c_str()), file_(file) {}
  void write(const char bytes[], int count) override {
    file_.write(bytes, static_cast<std::size_t>(count));
  }
  uint64_t tellp() override { return file_.position(); }
  void seekp(uint64_t position) override { file_.seek(position); }

 private:
  PendingFile& file_;
};

void encode(const Film& film, PendingFile& file) {
  PendingStream stream(file);
  Imf::OutputFile out(stream, header_of(film), Imf::globalThreadCount());
  Imf::FrameBuffer buffer;
  const Box2i window = window_of(film.data_window);
  for (const Plane& plane : film.planes) {
    buffer.insert(plane.channel, Imf::Slice::Make(Imf::FLOAT, plane.pixels.data(), window));
  }
  out.setFrameBuffer(buffer);
  out.writePixels(film.data_window.height());
}

// Compares bits, not values, so that equal NaNs are equal.
void verify(const Film& film, PendingFile& file) {
  Imf::InputFile in(file.temporary_path().c_str(), Imf::globalThreadCount());
  if (in.header().dataWindow() != window_of(film.data_window)) {
    file.fail("the data window that was read back differs from the film's");
  }
  std::vector<std::string> channels;
  for (const Plane& plane : film.planes) channels.push_back(plane.channel);
  for_each_strip(in, channels, [&](std::size_t first_pixel, const ExrRows& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const float* meant = film.planes[i].pixels.data() + first_pixel;
      if (std::memcmp(rows[i].data(), meant, rows[i].size() * sizeof(float)) != 0) {
        file.fail("channel " + channels[i] + " differs after reading it back");
      }
    }
  });
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
    if (text != nullptr && name.starts_with(kPrefix)) {
      metadata.settings.emplace_back(name.substr(kPrefix.size()), text->value());
    }
  }
  metadata.scene = take(metadata.settings, "scene");
  metadata.device = take(metadata.settings, "device");
  metadata.version = take(metadata.settings, "version");
  const std::string seed = take(metadata.settings, "seed");
  std::from_chars(seed.data(), seed.data() + seed.size(), metadata.seed);
  const auto* samples = header.findTypedAttribute<Imf::IntAttribute>(attribute_name("samples"));
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

void write_exr(const Film& film, const std::string& path) { write_exr(film, path, Durable::yes); }

void write_exr(const Film& film, const std::string& path, Durable durable) {
  PendingFile file(path);
  const std::string reason = film_defect(film);
  if (!reason.empty()) file.fail(reason);
  try {
    encode(film, file);
    file.close(durable);
    verify(film, file);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& problem) {
    file.fail(problem.what());
  }
  file.commit();
}

Film read_exr(const std::string& path) {
  Film film;
  ExrImage image =
      read_exr_image(path, [&](const Imf::Header& header) { film = film_without_pixels(header); });
  for (auto& [channel, pixels] : image.channels)
    film.planes.push_back({channel, std::move(pixels)});
  return film;
}

}  // namespace dapple
