// What plain and deep EXR files of a film have in common. In: a film. Out: attributes of their
// headers, and the stream that they are written to.
#pragma once

#include <ImfHeader.h>
#include <ImfIO.h>

#include <string>
#include <string_view>

#include "dapple/film.hpp"
#include "files/output_file.hpp"

namespace dapple {

/// How the names of our attributes begin.
inline constexpr std::string_view kExrPrefix = "dapple:";

/// The attribute with our prefix, cut to the length that OpenEXR allows.
std::string exr_attribute(const std::string& name);

Imath::Box2i exr_window(const PixelRect& rect);

/// A header of the film's windows, without channels.
Imf::Header exr_header(const Film& film, Imf::Compression compression);

void insert_metadata(Imf::Header& header, const FilmMetadata& metadata);

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

}  // namespace dapple
