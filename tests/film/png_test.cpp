// PNG previews, decoded again and compared with the closed form of the sRGB curve: the planes of a
// layer, how each kind of layer is scaled to the range of a PNG, and which films are refused.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include "film/png.hpp"

#include <gtest/gtest.h>
#include <stb_image.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "support/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<int> values;  // interleaved
};

class Png : public FilmFile {
 protected:
  // Writes `layer` as a PNG and decodes it.
  Image shown(const Film& film, const std::string& layer = "") {
    write_png(film, path("a.png"), layer);
    Image image;
    stbi_uc* pixels =
        stbi_load(path("a.png").c_str(), &image.width, &image.height, &image.channels, 0);
    EXPECT_NE(pixels, nullptr);
    if (pixels != nullptr) {
      image.values.assign(pixels, pixels + image.width * image.height * image.channels);
    }
    stbi_image_free(pixels);
    return image;
  }
};

// A film of one row of pixels; each plane holds its values from left to right.
Film row_film(std::vector<Plane> planes) {
  Film film;
  film.width = static_cast<int>(planes.front().pixels.size());
  film.height = 1;
  film.data_window = {0, 0, film.width - 1, 0};
  film.planes = std::move(planes);
  return film;
}

using Values = std::vector<int>;

TEST_F(Png, ColoursFollowTheSrgbCurve) {
  // 0.5 becomes 187.5160 of 255; 0.0031308, where the line and the power meet, becomes 10.3147.
  const Film film = row_film(
      {{"A", {0, 1, 1}}, {"B", {0.0031308f, 0, 1}}, {"G", {0.5f, 0, 1}}, {"R", {0.001f, 0, 1}}});
  const Image image = shown(film);
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.height, 1);
  EXPECT_EQ(image.channels, 3);
  EXPECT_EQ(image.values, (Values{3, 188, 10, 0, 0, 0, 255, 255, 255}));
}

TEST_F(Png, SrgbDecodesBackToWithinHalfAStep) {
  Plane plane{"ao", {}};
  for (int i = 0; i <= 1000; ++i) plane.pixels.push_back(static_cast<float>(i) / 1000.0f);
  const Image image = shown(row_film({plane}), "ao");
  ASSERT_EQ(image.values.size(), plane.pixels.size());
  for (std::size_t i = 0; i < plane.pixels.size(); ++i) {
    const double code = image.values[i] / 255.0;
    const auto decode = [](double c) {
      return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    // Half a step in both directions, and 1e-4 for the gap between line and power in the standard.
    EXPECT_GE(plane.pixels[i], decode(code - 0.5 / 255) - 1e-4) << i;
    EXPECT_LE(plane.pixels[i], decode(code + 0.5 / 255) + 1e-4) << i;
  }
}

TEST_F(Png, ValuesOutsideZeroAndOneAreClamped) {
  const Image image = shown(row_film({{"ao", {-1, -kInfinity, kNan, 1.5f, kInfinity}}}), "ao");
  EXPECT_EQ(image.channels, 1);
  EXPECT_EQ(image.values, (Values{0, 0, 0, 255, 255}));
}

TEST_F(Png, LayersOfThreeChannelsAreColour) {
  const Film film = row_film(
      {{"B", {0}}, {"G", {0}}, {"R", {0}}, {"ao.B", {0}}, {"ao.G", {0.5f}}, {"ao.R", {1}}});
  EXPECT_EQ(shown(film, "ao").values, (Values{255, 188, 0}));
  EXPECT_EQ(shown(film, "ao.G").values, (Values{188}));
}

TEST_F(Png, NormalsAreMappedLinearlyFromMinusOneToOne) {
  const Film film = row_film({{"N.X", {-1, 0}}, {"N.Y", {1, 0}}, {"N.Z", {0.5f, 0}}});
  // (0.5 + 1) / 2 * 255 = 191.25, and 0.5 * 255 = 127.5, which is rounded up.
  EXPECT_EQ(shown(film, "N").values, (Values{0, 255, 191, 128, 128, 128}));
}

TEST_F(Png, DistancesCoverTheirFiniteRangeAndInfinityIsWhite) {
  const Film film = row_film({{"Z", {10, 15, 20, kInfinity}}});
  EXPECT_EQ(shown(film, "Z").values, (Values{0, 128, 255, 255}));
}

TEST_F(Png, DistancesWithoutARangeCanStillBeWritten) {
  EXPECT_EQ(shown(row_film({{"Z", {3, 3}}}), "Z").values, (Values{0, 0}));
  EXPECT_EQ(shown(row_film({{"Z", {kInfinity}}}), "Z").values.size(), 1U);
}

TEST_F(Png, LightsAreDividedByTheirLargestValue) {
  const Film film =
      row_film({{"light.key.B", {0, 1}}, {"light.key.G", {2, 0}}, {"light.key.R", {4, 0}}});
  // 0.5 of the largest value becomes 188, and 0.25 becomes 136.9576.
  EXPECT_EQ(shown(film, "light.key").values, (Values{255, 188, 0, 0, 0, 137}));
  const Film dark = row_film({{"light.key", {0, 0}}});
  EXPECT_EQ(shown(dark, "light.key").values, (Values{0, 0}));
}

TEST_F(Png, HasTheSizeOfTheDataWindowWithTheFirstRowOnTop) {
  Film film;
  film.width = 100;
  film.height = 100;
  film.data_window = {10, 20, 10, 21};
  film.planes = {{"ao", {1, 0}}};
  const Image image = shown(film, "ao");
  EXPECT_EQ(image.width, 1);
  EXPECT_EQ(image.height, 2);
  EXPECT_EQ(image.values, (Values{255, 0}));
}

TEST_F(Png, MissingLayersAreRefusedWithTheFilmsChannels) {
  const Film film = row_film({{"Z", {1}}, {"ao.R", {1}}});
  const Error colour = error_of([&] { write_png(film, path("a.png")); });
  EXPECT_EQ(colour.kind(), ErrorKind::usage);
  const Error layer = error_of([&] { write_png(film, path("a.png"), "ao"); });
  EXPECT_EQ(layer.kind(), ErrorKind::usage);
  EXPECT_STREQ(layer.what(), "there is no layer ao for the PNG; the film's channels are: Z ao.R");
  EXPECT_EQ(files_in_folder(), 0U);
}

TEST_F(Png, FilmsThatAreNotWholeAreRefused) {
  Film film = row_film({{"ao", {1, 1}}});
  film.planes[0].pixels.pop_back();
  EXPECT_EQ(error_of([&] { write_png(film, path("a.png"), "ao"); }).kind(), ErrorKind::failed);
  EXPECT_EQ(files_in_folder(), 0U);
}

TEST_F(Png, UnwritablePathsAreNamed) {
  const Film film = row_film({{"ao", {1}}});
  const Error error = error_of([&] { write_png(film, path("missing/a.png"), "ao"); });
  EXPECT_EQ(error.kind(), ErrorKind::failed);
  EXPECT_TRUE(contains(error.what(), "cannot write " + path("missing/a.png"))) << error.what();
}

TEST_F(Png, SameFilmGivesTheSameBytes) {
  const Film film = ramp_film(40, 30);
  write_png(film, path("a.png"), "Z");
  write_png(film, path("b.png"), "Z");
  EXPECT_EQ(bytes_of(path("a.png")), bytes_of(path("b.png")));
}

TEST(Grey16Png, EveryValueIsRead) {
  constexpr int kSide = 256;
  std::vector<std::uint16_t> grey(kSide * kSide);
  for (std::size_t i = 0; i < grey.size(); ++i) grey[i] = static_cast<std::uint16_t>(i);
  const std::string bytes = encode_grey16_png(kSide, kSide, grey, "g.png");
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_us, decltype(&stbi_image_free)> pixels(
      stbi_load_16_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                               static_cast<int>(bytes.size()), &width, &height, &channels, 0),
      &stbi_image_free);
  ASSERT_NE(pixels, nullptr) << stbi_failure_reason();
  EXPECT_EQ((std::array{width, height, channels}), (std::array{kSide, kSide, 1}));
  EXPECT_EQ(std::vector<std::uint16_t>(pixels.get(), pixels.get() + grey.size()), grey);
}

}  // namespace
}  // namespace dapple
