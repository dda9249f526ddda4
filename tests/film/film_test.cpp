// Films as EXR files: reading a written film returns the same bits, and windows and metadata are in
// the attributes where other programs look for them.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

class FilmExr : public FilmFile {};

TEST_F(FilmExr, ReturnsEveryBitOfEveryChannel) {
  Film film = ramp_film(37, 150);  // more than two strips of 64 rows, and no multiple of 64
  film.planes[1].pixels[5] = std::numeric_limits<float>::infinity();
  film.planes[1].pixels[6] = std::bit_cast<float>(0x7fc12345U);  // a NaN with a payload
  film.planes[1].pixels[7] = -0.0f;
  film.planes[1].pixels[8] = std::numeric_limits<float>::denorm_min();
  write_exr(film, path("a.exr"));
  const Film back = read_exr(path("a.exr"));
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 150);
  EXPECT_EQ(back.data_window, film.data_window);
  ASSERT_EQ(back.planes.size(), 2U);
  EXPECT_EQ(back.planes[0].channel, "Z");
  EXPECT_EQ(back.planes[1].channel, "ao.R");
  EXPECT_EQ(bits_of(back.planes[0].pixels), bits_of(film.planes[0].pixels));
  EXPECT_EQ(bits_of(back.planes[1].pixels), bits_of(film.planes[1].pixels));
}

TEST_F(FilmExr, ChannelsComeBackInAlphabeticalOrder) {
  Film film = ramp_film(2, 2);
  std::swap(film.planes[0], film.planes[1]);
  write_exr(film, path("a.exr"));
  const Film back = read_exr(path("a.exr"));
  ASSERT_EQ(back.planes.size(), 2U);
  EXPECT_EQ(back.planes[0].channel, "Z");
  EXPECT_EQ(back.find("ao.R")->pixels, film.find("ao.R")->pixels);
}

TEST_F(FilmExr, HoldsACropInsideTheFullDisplayWindow) {
  Film film = ramp_film(3, 2);
  film.width = 640;
  film.height = 480;
  film.data_window = {10, 20, 12, 21};
  write_exr(film, path("a.exr"));
  Imf::InputFile file(path("a.exr").c_str());
  EXPECT_EQ(file.header().displayWindow(), Imath::Box2i({0, 0}, {639, 479}));
  EXPECT_EQ(file.header().dataWindow(), Imath::Box2i({10, 20}, {12, 21}));
  EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
  const Film back = read_exr(path("a.exr"));
  EXPECT_EQ(back.data_window, film.data_window);
  EXPECT_EQ(back.width, 640);
  EXPECT_EQ(back.find("Z")->pixels, film.find("Z")->pixels);
}

TEST_F(FilmExr, HasTheFirstRowAtTheTopAndFloatChannels) {
  write_exr(ramp_film(4, 3), path("a.exr"));
  Imf::InputFile file(path("a.exr").c_str());
  EXPECT_EQ(file.header().channels().findChannel("Z")->type, Imf::FLOAT);
  std::vector<float> top(4);
  Imf::FrameBuffer buffer;
  buffer.insert("Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(top.data()), sizeof(float), 0));
  file.setFrameBuffer(buffer);
  file.readPixels(0);  // EXR's y grows downwards
  EXPECT_EQ(top, (std::vector<float>{0, 1, 2, 3}));
}

TEST_F(FilmExr, TheScreenWindowIsAsWideAsTheImageAtADistanceOfOne) {
  Film film = ramp_film(4, 2);
  film.metadata = some_metadata();
  film.metadata.world_to_camera = M44f().setTranslation(V3f(1, 2, 3));
  M44f projection;  // a field of view of 90 degrees: x from -z to z becomes 0 to 1
  projection[0][0] = 0.5f;
  projection[2][0] = 0.5f;
  projection[2][3] = 1;
  projection[3][3] = 0;
  film.metadata.world_to_ndc = film.metadata.world_to_camera * projection;
  write_exr(film, path("a.exr"));
  Imf::InputFile file(path("a.exr").c_str());
  EXPECT_FLOAT_EQ(file.header().screenWindowWidth(), 2);
}

TEST_F(FilmExr, ReturnsItsMetadata) {
  Film film = ramp_film(2, 2);
  film.metadata = some_metadata();
  write_exr(film, path("a.exr"));
  const FilmMetadata back = read_exr(path("a.exr")).metadata;
  EXPECT_EQ(back.world_to_camera, film.metadata.world_to_camera);
  EXPECT_EQ(back.world_to_ndc, film.metadata.world_to_ndc);
  EXPECT_EQ(back.samples, 64);
  EXPECT_EQ(back.seed, 4'000'000'000U);
  EXPECT_EQ(back.scene, film.metadata.scene);
  EXPECT_EQ(back.device, film.metadata.device);
  EXPECT_EQ(back.version, film.metadata.version);
  EXPECT_EQ(back.settings, film.metadata.settings);
}

TEST_F(FilmExr, MetadataIsUtf8WhateverBytesNamesHave) {
  Film film = ramp_film(2, 2);
  film.metadata = some_metadata();
  film.metadata.scene = "/Bäume/tr\xe9\x65.glb";
  film.metadata.settings = {{"lamp", "l\xff"}};
  write_exr(film, path("a.exr"));
  const FilmMetadata back = read_exr(path("a.exr")).metadata;
  EXPECT_EQ(back.scene, "/Bäume/tr\xef\xbf\xbd\x65.glb");
  EXPECT_EQ(back.settings.at(0).second, "l\xef\xbf\xbd");
}

TEST_F(FilmExr, MetadataIsWhereOtherProgramsLookForIt) {
  Film film = ramp_film(2, 2);
  film.metadata = some_metadata();
  write_exr(film, path("a.exr"));
  Imf::InputFile file(path("a.exr").c_str());
  const Imf::Header& header = file.header();
  ASSERT_TRUE(Imf::hasWorldToCamera(header));
  ASSERT_TRUE(Imf::hasWorldToNDC(header));
  EXPECT_EQ(Imf::worldToCamera(header), film.metadata.world_to_camera);
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("dapple:footprint").value(), "1.5");
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("dapple:device").value(), "pthread-model");
}

TEST_F(FilmExr, SettingsCannotReplaceMetadata) {
  Film film = ramp_film(2, 2);
  film.metadata = some_metadata();
  film.metadata.settings = {{"device", "value of the option"}, {"samples", "1"}};
  write_exr(film, path("a.exr"));
  const FilmMetadata back = read_exr(path("a.exr")).metadata;
  EXPECT_EQ(back.device, "pthread-model");
  EXPECT_EQ(back.samples, 64);
}

TEST_F(FilmExr, SameFilmGivesTheSameBytes) {
  Film film = ramp_film(50, 70);
  film.metadata = some_metadata();
  write_exr(film, path("a.exr"));
  write_exr(film, path("b.exr"));
  EXPECT_EQ(bytes_of(path("a.exr")), bytes_of(path("b.exr")));
}

TEST_F(FilmExr, FilmsThatAreNotWholeAreRefused) {
  const auto refusal_of = [&](const std::function<void(Film&)>& damage) {
    Film film = ramp_film(2, 2);
    damage(film);
    std::string what = error_of([&] { write_exr(film, path("a.exr")); }).what();
    EXPECT_EQ(files_in_folder(), 0U);
    return what;
  };
  EXPECT_TRUE(contains(refusal_of([](Film& film) { film.planes[1].pixels.pop_back(); }),
                       "channel ao.R has 3 pixels, the data window 4"));
  EXPECT_TRUE(contains(refusal_of([](Film& film) { film.planes[1].channel = "Z"; }), "twice"));
  EXPECT_TRUE(contains(refusal_of([](Film& film) { film.planes[1].channel = ""; }), "no channel"));
  EXPECT_TRUE(contains(refusal_of([](Film& film) { film.planes.clear(); }), "no planes"));
  EXPECT_TRUE(contains(refusal_of([](Film& film) { film.data_window = {}; }), "empty"));
  EXPECT_TRUE(contains(
      refusal_of([](Film& film) { film.planes[0].channel = std::string(256, 'z'); }), "too long"));
}

TEST(Film, FindReturnsThePlaneOfThatNameOrNull) {
  const Film film = ramp_film(1, 1);
  EXPECT_EQ(film.find("ao.R"), &film.planes[1]);
  EXPECT_EQ(film.find("ao"), nullptr);
}

TEST(LayerName, KeepsLettersDigitsAndUnderscoresOnly) {
  EXPECT_EQ(layer_name("Key_light2"), "Key_light2");
  EXPECT_EQ(layer_name("light.key/1 a"), "light_key_1_a");
  EXPECT_EQ(layer_name("gr\xc3\xb6\xc3\x9f"
                       "e"),
            "gr__e");
}

TEST(LayerName, IsNeverEmptyAndNeverTooLongForAChannel) {
  EXPECT_EQ(layer_name(""), "unnamed");
  EXPECT_EQ(layer_name("\x80\x80"), "unnamed");
  EXPECT_LE(("light." + layer_name(std::string(1000, 'x')) + ".R").size(), 255U);
}

}  // namespace
}  // namespace dapple
