// Ways of storing a film: 16-bit floats by layer, parts, compressions and colour attributes. What
// is written so is read back by layer, and other programs find types, parts and names where they
// look.
#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "film/exr/exr_parts.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

class ExrFormatTest : public FilmFile {};

/// Smooth colours and data of every kind of layer.
Film layered_film() {
  Film film;
  film.width = 50;
  film.height = 40;
  film.data_window = {3, 2, 42, 38};
  film.metadata = some_metadata();
  for (const char* channel :
       {"R", "G", "B", "A", "ao.R", "light.sun.R", "light.sun.G", "light.sun.B", "light.sky.back.R",
        "N.X", "N.Y", "N.Z", "P.X", "Z", "samples", "crypto_object00.R", "error.light.sun"}) {
    const auto number = static_cast<float>(film.planes.size());
    film.planes.push_back({channel, {}});
    for (int y = 2; y <= 38; ++y)
      for (int x = 3; x <= 42; ++x)
        film.planes.back().pixels.push_back(1.3f + std::sin(0.05f * static_cast<float>(x + y)) +
                                            0.1f * number);
  }
  return film;
}

Film through_file(const Film& film, const std::string& path, const ExrFormat& format) {
  write_exr(film, path, format);
  return read_exr(path);
}

void expect_same_planes(const Film& back, const Film& film) {
  EXPECT_EQ(back.width, film.width);
  EXPECT_EQ(back.data_window, film.data_window);
  ASSERT_EQ(back.planes.size(), film.planes.size());
  for (const Plane& plane : film.planes) {
    ASSERT_NE(back.find(plane.channel), nullptr) << plane.channel;
    EXPECT_EQ(bits_of(back.find(plane.channel)->pixels), bits_of(plane.pixels)) << plane.channel;
  }
}

TEST_F(ExrFormatTest, LosslessCompressionsAndPartsReturnEveryBit) {
  Film film = layered_film();
  film.planes[13].pixels[7] = std::numeric_limits<float>::infinity();
  for (const bool multipart : {false, true}) {
    for (const ExrCompression compression :
         {ExrCompression::none, ExrCompression::zips, ExrCompression::zip, ExrCompression::piz}) {
      SCOPED_TRACE(testing::Message() << multipart << static_cast<int>(compression));
      const Film back = through_file(film, path("a.exr"), {compression, multipart, {}});
      expect_same_planes(back, film);
      EXPECT_EQ(back.metadata.device, film.metadata.device);
      EXPECT_EQ(back.metadata.world_to_camera, film.metadata.world_to_camera);
    }
  }
}

TEST_F(ExrFormatTest, HeadersNameTheCompression) {
  const std::pair<ExrCompression, Imf::Compression> all[] = {
      {ExrCompression::none, Imf::NO_COMPRESSION},
      {ExrCompression::zips, Imf::ZIPS_COMPRESSION},
      {ExrCompression::zip, Imf::ZIP_COMPRESSION},
      {ExrCompression::piz, Imf::PIZ_COMPRESSION}};
  for (const auto& [given, stored] : all) {
    write_exr(ramp_film(4, 3), path("a.exr"), {given, false, {}});
    EXPECT_EQ(Imf::InputFile(path("a.exr").c_str()).header().compression(), stored);
  }
}

TEST_F(ExrFormatTest, HalfLayersAreRoundedAndOthersAreNot) {
  const Film film = layered_film();
  const Film back = through_file(film, path("a.exr"), {ExrCompression::zip, false, {"light", "N"}});
  Imf::InputFile file(path("a.exr").c_str());
  for (const Plane& plane : film.planes) {
    const std::string& name = plane.channel;
    const bool is_half = name.starts_with("light.") || name.starts_with("N.");
    SCOPED_TRACE(name);
    EXPECT_EQ(file.header().channels().findChannel(name)->type, is_half ? Imf::HALF : Imf::FLOAT);
    const std::vector<float>& read = back.find(name)->pixels;
    float error = 0;
    for (std::size_t p = 0; p < read.size(); ++p)
      error = std::max(error, std::fabs(read[p] / plane.pixels[p] - 1));
    // A half has 11 significant bits: rounding changes it by at most 2^-11.
    EXPECT_LE(error, is_half ? std::ldexp(1.0f, -11) : 0.0f);
    EXPECT_EQ(error > 0, is_half);
  }
}

TEST_F(ExrFormatTest, AllMeansAllButDistancesPositionsNumbersAndIds) {
  write_exr(layered_film(), path("a.exr"), {ExrCompression::zip, false, {"all"}});
  Imf::InputFile file(path("a.exr").c_str());
  for (const char* channel : {"Z", "P.X", "samples", "crypto_object00.R"})
    EXPECT_EQ(file.header().channels().findChannel(channel)->type, Imf::FLOAT) << channel;
  for (const char* channel : {"R", "A", "ao.R", "light.sun.G", "N.X", "error.light.sun"})
    EXPECT_EQ(file.header().channels().findChannel(channel)->type, Imf::HALF) << channel;
}

TEST_F(ExrFormatTest, HalvesBeyondTheirRangeAreTheLargestAndInfinityStays) {
  Film film = ramp_film(4, 1);
  film.planes[1].pixels = {1e6f, -1e6f, std::numeric_limits<float>::infinity(), 65504};
  const Film back = through_file(film, path("a.exr"), {ExrCompression::zip, false, {"ao"}});
  EXPECT_EQ(back.find("ao.R")->pixels,
            (std::vector<float>{65504, -65504, std::numeric_limits<float>::infinity(), 65504}));
}

TEST_F(ExrFormatTest, EachLayerIsAPartWithItsNameAndColourSpace) {
  write_exr(layered_film(), path("a.exr"), {ExrCompression::zip, true, {}});
  Imf::MultiPartInputFile file(path("a.exr").c_str());
  std::vector<std::string> names, colors;
  for (int i = 0; i < file.parts(); ++i) {
    const Imf::Header& header = file.header(i);
    EXPECT_EQ(header.type(), Imf::SCANLINEIMAGE);
    names.push_back(header.name());
    const auto id = header.typedAttribute<Imf::StringAttribute>("colorInteropID").value();
    if (id == "lin_rec709_scene") colors.push_back(header.name());
    EXPECT_TRUE(id == "data" || colors.back() == header.name()) << id;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"RGBA", "ao", "light.sun", "light.sky.back", "N", "P",
                                             "Z", "samples", "crypto_object00", "error.light"}));
  EXPECT_EQ(colors, (std::vector<std::string>{"RGBA", "light.sun", "light.sky.back"}));
  EXPECT_EQ(file.header(0).typedAttribute<Imf::StringAttribute>("dapple:device").value(),
            "pthread-model");
}

TEST_F(ExrFormatTest, AFileOfOnePartIsLinearWithThePrimariesOfBt709) {
  write_exr(ramp_film(2, 2), path("a.exr"));
  Imf::InputFile file(path("a.exr").c_str());
  const Imf::Header& header = file.header();
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("colorInteropID").value(),
            "lin_rec709_scene");
  ASSERT_TRUE(Imf::hasChromaticities(header));
  EXPECT_EQ(Imf::chromaticities(header).red, Imath::V2f(0.64f, 0.33f));
  EXPECT_EQ(Imf::chromaticities(header).white, Imath::V2f(0.3127f, 0.329f));
}

TEST_F(ExrFormatTest, DwaaIsForColoursOnly) {
  const Film film = layered_film();
  const Film back = through_file(film, path("a.exr"), {ExrCompression::dwaa, true, {}});
  Imf::MultiPartInputFile file(path("a.exr").c_str());
  for (int i = 0; i < file.parts(); ++i) {
    const std::string name = file.header(i).name();
    const bool is_color = name == "RGBA" || name.starts_with("light.");
    EXPECT_EQ(file.header(i).compression(), is_color ? Imf::DWAA_COMPRESSION : Imf::ZIP_COMPRESSION)
        << name;
  }
  for (const Plane& plane : film.planes) {
    const bool is_color = layer_of(plane.channel) == "RGBA" || plane.channel.starts_with("light.");
    double square = 0;
    const std::vector<float>& read = back.find(plane.channel)->pixels;
    for (std::size_t p = 0; p < read.size(); ++p)
      square += std::pow(double{read[p]} - plane.pixels[p], 2);
    const double rmse = std::sqrt(square / static_cast<double>(read.size()));
    EXPECT_LE(rmse, is_color ? 0.02 : 0.0) << plane.channel;
  }
}

// DWAA codes colours as 16-bit floats, with errors: beside bright edges some would pass 65504.
TEST_F(ExrFormatTest, DwaaOfBrightColoursStaysFinite) {
  Film film = ramp_film(128, 128);
  std::mt19937 bits(5);
  std::vector<float> bright;
  for (int i = 0; i < 128 * 128; ++i) bright.push_back(bits() % 2 == 0 ? 0.0f : 1e6f);
  film.planes.clear();
  for (const char* channel : {"R", "G", "B", "A"})
    film.planes.push_back(
        {channel, channel[0] == 'A' ? std::vector<float>(128 * 128, 1.0f) : bright});
  for (const std::vector<std::string>& half : {std::vector<std::string>{}, {"all"}}) {
    const Film back = through_file(film, path("a.exr"), {ExrCompression::dwaa, true, half});
    for (const Plane& plane : back.planes)
      for (const float value : plane.pixels) ASSERT_TRUE(std::isfinite(value)) << plane.channel;
  }
}

TEST_F(ExrFormatTest, ImpossibleFormatsAreRefusedBeforeAnythingIsWritten) {
  const auto refusal = [&](const ExrFormat& format) {
    const Error error = error_of([&] { write_exr(layered_film(), path("a.exr"), format); });
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_EQ(files_in_folder(), 0u);
    return std::string(error.what());
  };
  EXPECT_EQ(refusal({ExrCompression::zip, false, {"ao", "Z"}}),
            "--half Z: this layer stays 32-bit");
  EXPECT_EQ(refusal({ExrCompression::zip, false, {"crypto_object00"}}),
            "--half crypto_object00: this layer stays 32-bit");
  EXPECT_TRUE(
      contains(refusal({ExrCompression::dwaa, false, {}}), "--compression dwaa needs --multipart"));
}

TEST(HalfLayers, NamesThatNoLayerHasAreKnown) {
  EXPECT_EQ(
      half_layers_without_planes(
          layered_film(), {ExrCompression::zip, false, {"all", "light", "ligh", "error", "no"}}),
      (std::vector<std::string>{"ligh", "no"}));
}

/// Two parts with channels Y of 2x2 pixels, from another program.
void write_two_parts(const std::string& path, const Imath::Box2i& second_window) {
  std::vector<Imf::Header> headers;
  for (const char* name : {"left", "right"}) {
    const Imath::Box2i window = headers.empty() ? Imath::Box2i({0, 0}, {1, 1}) : second_window;
    headers.emplace_back(Imath::Box2i({0, 0}, {3, 3}), window);
    headers.back().channels().insert("Y", Imf::Channel(Imf::FLOAT));
    headers.back().setName(name);
    headers.back().setType(Imf::SCANLINEIMAGE);
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 2);
  const std::vector<float> values[2] = {{1, 2, 3, 4}, {5, 6, 7, 8}};
  for (int i = 0; i < 2; ++i) {
    Imf::OutputPart part(file, i);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, values[i].data(),
                                        headers[static_cast<std::size_t>(i)].dataWindow()));
    part.setFrameBuffer(buffer);
    part.writePixels(2);
  }
}

TEST_F(ExrFormatTest, PartsOfOtherProgramsAreReadUnderTheirNamesWhereChannelsAreTheSame) {
  write_two_parts(path("a.exr"), {{0, 0}, {1, 1}});
  const Film film = read_exr(path("a.exr"));
  EXPECT_EQ(film.find("Y")->pixels, (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(film.find("right.Y")->pixels, (std::vector<float>{5, 6, 7, 8}));
  write_two_parts(path("b.exr"), {{1, 1}, {2, 2}});
  EXPECT_TRUE(contains(error_of([&] { read_exr(path("b.exr")); }).what(),
                       "its parts have different data windows"));
}

TEST_F(ExrFormatTest, ADamagedFileOfPartsIsRefusedOrReadButNeverMore) {
  write_exr(layered_film(), path("a.exr"), {ExrCompression::piz, true, {"all"}});
  const std::string whole = bytes_of(path("a.exr"));
  int refused = 0;
  for (std::size_t i = 0; i < whole.size(); i += i < 1500 ? 3 : 101) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(~damaged[i]);
    write_bytes(path("damaged.exr"), damaged);
    try {
      read_exr(path("damaged.exr"));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << "byte " << i;
      ++refused;
    }
    write_bytes(path("cut.exr"), whole.substr(0, i));
    EXPECT_THROW(read_exr(path("cut.exr")), Error) << i;
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace dapple
