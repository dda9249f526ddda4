// Writes the opacities at depths of a film as a deep scanline EXR file. In: a Film. Out: a file.
// OpenEXR compresses deep data line by line only.
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfPartType.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cstdint>

#include "dapple/error.hpp"
#include "film/exr/exr_writer_header.hpp"

namespace dapple {
namespace {

using Sample = DeepAlpha::Sample;

/// Numbers of samples of all pixels, and where each pixel's values of a channel begin.
struct DeepPointers {
  std::vector<unsigned> count;
  std::vector<const float*> z, alpha;
};

/// `samples`: those of all pixels one after the other.
DeepPointers pointers_to(const DeepAlpha& deep, const Sample* samples) {
  static_assert(sizeof(Sample) == 2 * sizeof(float));
  const auto* values = reinterpret_cast<const float*>(samples);
  const std::size_t pixels = deep.first.size() - 1;
  DeepPointers to;
  to.count.reserve(pixels);
  to.z.reserve(pixels);
  to.alpha.reserve(pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    to.count.push_back(static_cast<unsigned>(deep.first[p + 1] - deep.first[p]));
    to.z.push_back(values + 2 * deep.first[p]);
    to.alpha.push_back(values + 2 * deep.first[p] + 1);
  }
  return to;
}

/// OpenEXR adds offsets to the address of pixel (0, 0), which may lie outside of the data window.
char* at_origin(const void* first, std::size_t bytes, const Imath::Box2i& window) {
  const std::ptrdiff_t width = window.max.x - window.min.x + 1;
  const std::ptrdiff_t before = window.min.x + window.min.y * width;
  const auto address = reinterpret_cast<std::uintptr_t>(first);
  return reinterpret_cast<char*>(address - static_cast<std::uintptr_t>(before) * bytes);
}

Imf::DeepFrameBuffer frame_buffer(const DeepPointers& to, const Imath::Box2i& window) {
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT,
                                           at_origin(to.count.data(), sizeof(unsigned), window),
                                           sizeof(unsigned), sizeof(unsigned) * width));
  const auto insert = [&](const char* channel, const std::vector<const float*>& values) {
    buffer.insert(channel,
                  Imf::DeepSlice(Imf::FLOAT, at_origin(values.data(), sizeof(float*), window),
                                 sizeof(float*), sizeof(float*) * width, sizeof(Sample)));
  };
  insert("Z", to.z);
  insert("A", to.alpha);
  return buffer;
}

void encode(const Film& film, PendingFile& file) {
  Imf::Header header = exr_header(film, Imf::ZIPS_COMPRESSION);
  header.setType(Imf::DEEPSCANLINE);
  header.channels().insert("A", Imf::Channel(Imf::FLOAT));
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  insert_metadata(header, film.metadata);
  PendingStream stream(file);
  Imf::DeepScanLineOutputFile out(stream, header, Imf::globalThreadCount());
  const DeepPointers to = pointers_to(film.deep, film.deep.samples.data());
  out.setFrameBuffer(frame_buffer(to, exr_window(film.data_window)));
  out.writePixels(film.data_window.height());
}

}  // namespace

void write_deep_exr(const Film& film, const std::string& path) {
  PendingFile file(path);
  const auto pixels =
      static_cast<std::size_t>(film.data_window.width()) * film.data_window.height();
  const std::vector<std::size_t>& first = film.deep.first;
  if (first.size() != pixels + 1) file.fail("the film has no depths");
  if (first.front() != 0 || first.back() != film.deep.samples.size() ||
      !std::is_sorted(first.begin(), first.end()))
    file.fail("the depths of its pixels do not follow each other");
  try {
    encode(film, file);
    file.close();
    file.verify();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& problem) {
    file.fail(problem.what());
  }
  file.commit();
}

}  // namespace dapple
