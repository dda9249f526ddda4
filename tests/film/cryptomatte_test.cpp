// Cryptomatte's hash, ids, ranks and attributes: test vectors of MurmurHash3 and of the
// specification, and small films whose layers are known.
#include "film/cryptomatte.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

TEST(Murmur3, GivesTheKnownHashes) {
  EXPECT_EQ(murmur3_32(""), 0u);
  EXPECT_EQ(murmur3_32("hello"), 0x248bfa47u);
  EXPECT_EQ(murmur3_32("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(murmur3_32("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

TEST(MatteId, IsTheOneOfTheSpecificationsExamples) {
  EXPECT_EQ(matte_id("bunny"), 0x13851a76u);
  EXPECT_EQ(matte_id("default"), 0x42c9679fu);
  EXPECT_EQ(matte_id("bunny_porcelain_mat"), 0xb24b26d4u);
}

TEST(MatteId, IsANormalFloatWhateverTheHash) {
  int clamped = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::string name = "leaf_" + std::to_string(i);
    EXPECT_TRUE(std::isnormal(std::bit_cast<float>(matte_id(name)))) << name;
    clamped += matte_id(name) != murmur3_32(name);
  }
  // Two of 256 exponents are clamped.
  EXPECT_NEAR(clamped, 100'000 * 2 / 256, 150);
}

const MatteNames kNames{{"a", "b", "c", "a2", "d", "e", "f", "g"}, {"leaf", "bark"}};

Film film_with(const MatteSums& sums, std::uint32_t samples, const Cryptomattes& wanted,
               const MatteNames& names = kNames) {
  Film film;
  film.width = static_cast<int>(sums.pixel_count());
  film.height = 1;
  film.data_window = {0, 0, film.width - 1, 0};
  add_cryptomattes(film, sums, std::vector<std::uint32_t>(sums.pixel_count(), samples), names,
                   wanted);
  return film;
}

void add(MatteSums& sums, std::size_t pixel, std::uint32_t object, std::uint32_t material,
         int count) {
  for (int i = 0; i < count; ++i) sums.add(pixel, object, material, 5);
}

float at(const Film& film, const std::string& channel, std::size_t pixel) {
  return film.find(channel)->pixels.at(pixel);
}

TEST(Cryptomatte, LayersHaveIdsInTheOrderOfTheirCoverage) {
  MatteSums sums(2);
  add(sums, 1, 0, 0, 2);
  add(sums, 1, 1, 0, 3);
  add(sums, 1, 0, 1, 4);  // object a again, with another material
  const Film film = film_with(sums, 16, {true, true});
  EXPECT_EQ(std::bit_cast<std::uint32_t>(at(film, "crypto_object00.R", 1)), matte_id("a"));
  EXPECT_EQ(at(film, "crypto_object00.G", 1), 6.0f / 16);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(at(film, "crypto_object00.B", 1)), matte_id("b"));
  EXPECT_EQ(at(film, "crypto_object00.A", 1), 3.0f / 16);
  EXPECT_EQ(at(film, "crypto_object01.R", 1), 0);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(at(film, "crypto_material00.R", 1)), matte_id("leaf"));
  EXPECT_EQ(at(film, "crypto_material00.G", 1), 5.0f / 16);
  for (const Plane& plane : film.planes) EXPECT_EQ(plane.pixels[0], 0) << "no sample hit";
  EXPECT_EQ(film.planes.size(), 16u) << "of eight objects and two materials";
}

TEST(Cryptomatte, SixIdsArePresentAndNamesThatAreTheSameAreOneId) {
  MatteSums sums(1);
  for (std::uint32_t object = 0; object < 8; ++object)
    add(sums, 0, object, 0, 1 + static_cast<int>(object));
  MatteNames names = kNames;
  names.objects[3] = "g";  // as object 7
  const Film film = film_with(sums, 40, {true, false}, names);
  EXPECT_EQ(film.planes.size(), 12u);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(at(film, "crypto_object00.R", 0)), matte_id("g"));
  EXPECT_EQ(at(film, "crypto_object00.G", 0), 12.0f / 40);
  EXPECT_EQ(at(film, "crypto_object02.A", 0), 2.0f / 40) << "the sixth, object b";
}

TEST(Cryptomatte, AttributesAreWhereOtherProgramsLookAndComeBack) {
  const MatteSums sums(3);
  MatteNames names = kNames;
  names.objects[0] = "quote \" and \xc3\xb6";
  const Film film = film_with(sums, 4, {true, false}, names);
  const auto& attributes = film.metadata.attributes;
  ASSERT_EQ(attributes.size(), 4u);
  char key[9];
  std::snprintf(key, sizeof key, "%08x", murmur3_32("crypto_object"));
  const std::string prefix = "cryptomatte/" + std::string(key, 7) + "/";
  EXPECT_EQ(attributes[0], std::pair(prefix + "name", std::string("crypto_object")));
  EXPECT_EQ(attributes[1], std::pair(prefix + "hash", std::string("MurmurHash3_32")));
  EXPECT_EQ(attributes[2], std::pair(prefix + "conversion", std::string("uint32_to_float32")));
  EXPECT_EQ(attributes[3].first, prefix + "manifest");
  EXPECT_TRUE(contains(attributes[3].second, "\"quote \\\" and \xc3\xb6\":\""));
  EXPECT_TRUE(contains(attributes[3].second, "\"a2\":\""));
}

class CryptomatteFile : public FilmFile {};

TEST_F(CryptomatteFile, IdsAndAttributesSurviveEveryFormat) {
  MatteSums sums(4);
  for (std::size_t p = 0; p < 4; ++p) add(sums, p, static_cast<std::uint32_t>(p), 1, 3);
  const Film film = film_with(sums, 4, {true, true});
  for (const ExrFormat& format : {ExrFormat{}, ExrFormat{ExrCompression::dwaa, true, {"all"}},
                                  ExrFormat{ExrCompression::piz, false, {"all"}}}) {
    write_exr(film, path("a.exr"), format);
    const Film back = read_exr(path("a.exr"));
    for (const Plane& plane : film.planes)
      EXPECT_EQ(bits_of(back.find(plane.channel)->pixels), bits_of(plane.pixels)) << plane.channel;
    EXPECT_EQ(back.metadata.attributes.size(), film.metadata.attributes.size());
    for (const auto& attribute : film.metadata.attributes)
      EXPECT_NE(
          std::find(back.metadata.attributes.begin(), back.metadata.attributes.end(), attribute),
          back.metadata.attributes.end())
          << attribute.first;
  }
}

TEST(MatteSums, CountAtMostSoManySlotsOfAPixel) {
  MatteSums sums(1);
  for (std::uint32_t object = 0; object < 300; ++object) add(sums, 0, object, 0, 2);
  add(sums, 0, 255, 0, 1);
  ASSERT_EQ(sums.of_pixel(0).size(), kMaxMatteSlots);
  EXPECT_EQ(sums.of_pixel(0)[255], (MatteSlot{255, 0, 3, 5}));
}

// What a picture keeps of many slots is what its earliest samples hit, in whatever order parts
// come.
TEST(MatteSums, MergedSlotsBeganAtTheEarlierSample) {
  MatteSums sums(2);
  for (std::size_t p = 0; p < 2; ++p) {
    const MatteSlot early{1, 0, 2, 3}, late{1, 0, 5, 40};
    sums.add(p, {p == 0 ? early : late});
    sums.add(p, {p == 0 ? late : early});
    EXPECT_EQ(sums.of_pixel(p), (std::vector<MatteSlot>{{1, 0, 7, 3}})) << p;
  }
}

TEST(MatteSums, PackAndUnpackAndRefuseWhatIsNotTheirs) {
  MatteSums sums(3);
  add(sums, 0, 1, 2, 5);
  add(sums, 2, 3, 0, 1);
  add(sums, 2, 0, 1, 7);
  const std::vector<std::uint32_t> packed = sums.packed();
  MatteSums back;
  ASSERT_TRUE(back.unpack(packed, 3, 4, 3));
  for (std::size_t p = 0; p < 3; ++p) EXPECT_EQ(back.of_pixel(p), sums.of_pixel(p));
  EXPECT_FALSE(back.unpack(packed, 2, 4, 3));
  EXPECT_FALSE(back.unpack(packed, 4, 4, 3));
  EXPECT_FALSE(back.unpack(packed, 3, 3, 3)) << "object 3";
  EXPECT_FALSE(back.unpack(packed, 3, 4, 2)) << "material 2";
  for (std::size_t size = 0; size < packed.size(); ++size)
    EXPECT_FALSE(back.unpack(std::span(packed).first(size), 3, 4, 3)) << size;
  EXPECT_FALSE(back.unpack(std::vector<std::uint32_t>{33}, 1));
}

}  // namespace
}  // namespace dapple
