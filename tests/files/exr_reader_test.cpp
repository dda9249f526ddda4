// The EXR reader. It reads files of other programs, and refuses damaged files with a message that
// names them. It never allocates more pixels than the file can hold.
#include "files/exr_reader.hpp"

#include <ImfChannelList.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringVectorAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

class ExrReader : public FilmFile {};

Imf::Header foreign_header(Imf::PixelType type) {
  Imf::Header header(Imath::Box2i({5, 5}, {14, 24}), Imath::Box2i({4, 6}, {7, 8}));
  header.channels().insert("Y", Imf::Channel(type));
  return header;
}

const std::vector<float> kForeignPixels = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

TEST_F(ExrReader, TakesHalfAndUnsignedChannelsAndMovedWindows) {
  const std::vector<half> halves(kForeignPixels.begin(), kForeignPixels.end());
  const std::vector<unsigned> integers(kForeignPixels.begin(), kForeignPixels.end());
  for (const Imf::PixelType type : {Imf::HALF, Imf::UINT}) {
    const void* pixels = type == Imf::HALF ? static_cast<const void*>(halves.data())
                                           : static_cast<const void*>(integers.data());
    const Imf::Header header = foreign_header(type);
    {
      Imf::OutputFile file(path("a.exr").c_str(), header);
      Imf::FrameBuffer buffer;
      buffer.insert("Y", Imf::Slice::Make(type, pixels, header.dataWindow()));
      file.setFrameBuffer(buffer);
      file.writePixels(3);
    }
    const Film film = read_exr(path("a.exr"));
    EXPECT_EQ(film.width, 10);
    EXPECT_EQ(film.height, 20);
    EXPECT_EQ(film.data_window, (PixelRect{-1, 1, 2, 3}));
    ASSERT_EQ(film.planes.size(), 1U);
    EXPECT_EQ(film.planes[0].pixels, kForeignPixels);
  }
}

TEST_F(ExrReader, TakesTiles) {
  Imf::Header header = foreign_header(Imf::FLOAT);
  header.setTileDescription(Imf::TileDescription(2, 2));
  {
    Imf::TiledOutputFile file(path("a.exr").c_str(), header);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, kForeignPixels.data(), header.dataWindow()));
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  EXPECT_EQ(read_exr(path("a.exr")).planes.at(0).pixels, kForeignPixels);
}

// Of one pixel each, more than the file has bytes: it is written by lines all the same.
TEST_F(ExrReader, TakesLinesWhoseHeaderNamesTiles) {
  constexpr int kSide = 64;
  Imf::Header header(kSide, kSide);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  header.setTileDescription(Imf::TileDescription(1, 1));
  header.compression() = Imf::ZIP_COMPRESSION;
  const std::vector<float> pixels(std::size_t{kSide} * kSide, 0.5f);
  {
    Imf::OutputFile file(path("a.exr").c_str(), header);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, pixels.data(), header.dataWindow()));
    file.setFrameBuffer(buffer);
    file.writePixels(kSide);
  }
  std::string bytes = bytes_of(path("a.exr"));
  ASSERT_EQ(bytes[5], 2) << "OpenEXR sets the flag of tiles for the attribute";
  bytes[5] = 0;
  write_bytes(path("a.exr"), bytes);
  EXPECT_EQ(read_exr(path("a.exr")).planes.at(0).pixels, pixels);
}

void expect_refused(const std::string& path, const std::string& why) {
  const Error error = error_of([&] { read_exr(path); });
  EXPECT_EQ(error.kind(), ErrorKind::input);
  EXPECT_TRUE(contains(error.what(), path)) << error.what();
  EXPECT_TRUE(contains(error.what(), why)) << error.what();
}

TEST_F(ExrReader, RefusesFilesThatAreNotExr) {
  write_bytes(path("text.exr"), "this is no picture at all");
  write_bytes(path("empty.exr"), "");
  expect_refused(path("text.exr"), "not an EXR file");
  expect_refused(path("empty.exr"), "");
  expect_refused(path("missing.exr"), "no such file");
  expect_refused(folder_.string(), "not a regular file");
}

TEST_F(ExrReader, RefusesTruncatedFiles) {
  write_exr(ramp_film(20, 40), path("a.exr"));
  const std::string whole = bytes_of(path("a.exr"));
  for (std::size_t length = 0; length < whole.size(); length += 29) {
    write_bytes(path("cut.exr"), whole.substr(0, length));
    expect_refused(path("cut.exr"), "");
  }
}

TEST_F(ExrReader, SurvivesDamagedBytes) {
  Film film = ramp_film(20, 40);
  film.metadata = some_metadata();
  write_exr(film, path("a.exr"));
  const std::string whole = bytes_of(path("a.exr"));
  int refused = 0;
  // Damages every byte of the header, and some bytes of the pixels.
  for (std::size_t i = 0; i < whole.size(); i += i < 1200 ? 1 : 13) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(~damaged[i]);
    write_bytes(path("damaged.exr"), damaged);
    try {
      read_exr(path("damaged.exr"));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << "byte " << i;
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);  // at least magic, version, types, sizes and ZIP's checksums
}

// The file `exr` with another data window in its header, but the same pixels.
std::string with_data_window(std::string exr, const Imath::Box2i& window) {
  const std::string name("dataWindow\0box2i\0\x10\0\0\0", 21);
  const std::size_t at = exr.find(name) + name.size();
  return exr.replace(at, sizeof window, reinterpret_cast<const char*>(&window), sizeof window);
}

TEST_F(ExrReader, RefusesHugeWindowsBeforeItAllocatesThem) {
  write_exr(ramp_film(2, 2), path("a.exr"));
  const std::string small = bytes_of(path("a.exr"));
  write_bytes(path("b.exr"), with_data_window(small, {{0, 0}, {99'999, 99'999}}));
  expect_refused(path("b.exr"), "100000 x 100000 pixels is over the limit of 268435456");
  // The window is within the limit, but the file is too short for its pixels.
  write_bytes(path("c.exr"), with_data_window(small, {{0, 0}, {16'000, 16'000}}));
  expect_refused(path("c.exr"), "");
}

TEST_F(ExrReader, RefusesRowsThatTheFileHasNoRoomFor) {
  write_exr(ramp_film(2, 2), path("a.exr"));
  write_bytes(path("b.exr"), with_data_window(bytes_of(path("a.exr")), {{0, 0}, {4'000'000, 60}}));
  expect_refused(path("b.exr"), "damaged: its image is larger than the file");
}

TEST_F(ExrReader, RefusesMoreTilesThanTheFileHasRoomFor) {
  Imf::Header header(1, 1);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  header.setTileDescription({1, 1, Imf::ONE_LEVEL});
  {
    Imf::TiledOutputFile file(path("tile.exr").c_str(), header);
    float pixel = 0.5f;
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&pixel), 4, 4));
    file.setFrameBuffer(buffer);
    file.writeTile(0, 0);
  }
  EXPECT_EQ(ExrFile(path("tile.exr")).image().channels.at("Y").at(0), 0.5f);
  write_bytes(path("tiles.exr"),
              with_data_window(bytes_of(path("tile.exr")), {{0, 0}, {9'999, 9'999}}));
  expect_refused(path("tiles.exr"), "damaged: its image is larger than the file");
}

TEST_F(ExrReader, RefusesAttributesThatAreLargerThanTheFileBeforeItAllocatesThem) {
  Film film = ramp_film(2, 2);
  film.metadata = some_metadata();
  write_exr(film, path("a.exr"));
  std::string exr = bytes_of(path("a.exr"));
  // The name, the type of a text, and its size, in four bytes.
  const std::string type("\0string\0", 8);
  const std::size_t at = exr.find(type);
  ASSERT_NE(at, std::string::npos);
  exr.replace(at + type.size(), 4, "\xff\xff\xff\x7f");
  write_bytes(path("b.exr"), exr);
  expect_refused(path("b.exr"), "an attribute of its header is larger than the file");
}

// OpenEXR reads eight bytes whatever the size, and then takes bytes of the value
// for the next attribute's name, type and size: here of 2 GB.
TEST_F(ExrReader, RefusesAttributesThatMisstateTheSizeOfTheirType) {
  write_exr(ramp_film(2, 2), path("a.exr"));
  std::string exr = bytes_of(path("a.exr"));
  const std::string name("screenWindowCenter\0v2f\0", 23);
  const std::size_t at = exr.find(name) + name.size();
  ASSERT_GE(at, name.size());
  exr.insert(at + 4 + 8, std::string("x\0y\0\xff\xff\xff\x7f", 8));
  exr[at] = 16;
  write_bytes(path("b.exr"), exr);
  expect_refused(
      path("b.exr"),
      "damaged: the attribute screenWindowCenter of its header has 16 bytes, which no v2f");
}

TEST_F(ExrReader, ReadsListsOfTextsAndRefusesThoseThatReachBeyondThemselves) {
  Imf::Header header(1, 1);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  header.insert("texts", Imf::StringVectorAttribute({"", "ab", ""}));
  { Imf::OutputFile file(path("a.exr").c_str(), header); }
  EXPECT_EQ(ExrFile(path("a.exr")).width(), 1u);
  std::string exr = bytes_of(path("a.exr"));
  const std::size_t at = exr.find(std::string("\2\0\0\0ab", 6));
  ASSERT_NE(at, std::string::npos);
  exr.replace(at, 4, "\xff\xff\xff\x7f");
  write_bytes(path("b.exr"), exr);
  expect_refused(path("b.exr"),
                 "damaged: the attribute texts of its header has 14 bytes, which no");
}

// OpenEXR reads whole numbers of four bytes, and takes what is left for the next attribute.
TEST_F(ExrReader, RefusesPartsOfNumbers) {
  Imf::Header header(1, 1);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  header.insert("numbers", Imf::FloatVectorAttribute({1, 2}));
  { Imf::OutputFile file(path("a.exr").c_str(), header); }
  EXPECT_EQ(ExrFile(path("a.exr")).width(), 1u);
  std::string exr = bytes_of(path("a.exr"));
  const std::string type("numbers\0floatvector\0", 20);
  const std::size_t at = exr.find(type);
  ASSERT_NE(at, std::string::npos);
  exr[at + type.size()] = 10;
  exr.insert(at + type.size() + 12, "x\0", 2);
  write_bytes(path("b.exr"), exr);
  expect_refused(path("b.exr"), "the attribute numbers of its header has 10 bytes, which no");
}

TEST_F(ExrReader, RefusesSubsampledChannels) {
  Imf::Header header(4, 4);
  header.channels().insert("BY", Imf::Channel(Imf::FLOAT, 2, 2));
  { Imf::OutputFile file(path("a.exr").c_str(), header); }
  expect_refused(path("a.exr"), "channel BY is subsampled");
}

}  // namespace
}  // namespace dapple
