// PNG previews, decoded again and compared with the closed form of the sRGB curve: the planes of a
// layer, how each kind of layer is scaled to the range of a PNG, and which films are refused.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include "film/preview/png.hpp"

#include <gtest/gtest.h>
#include <stb_image.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "film/preview/pixel_elevation.hpp"
#include "film/preview/tone_map.hpp"
#include "support/files/film_files.hpp"

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
  Image shown(const Film& film, const std::string& layer = "", const PngOptions& options = {}) {
    write_png(film, path("a.png"), layer, options);
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
  const Film film =
      row_film({{"ao.B", {0.0031308f, 0, 1}}, {"ao.G", {0.5f, 0, 1}}, {"ao.R", {0.001f, 0, 1}}});
  const Image image = shown(film, "ao");
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.height, 1);
  EXPECT_EQ(image.channels, 3);
  EXPECT_EQ(image.values, (Values{3, 188, 10, 0, 0, 0, 255, 255, 255}));
}

using Background = PngOptions::Background;

PngOptions shown_as(float stops, Background background, const V3f& color = V3f(0, 0, 0)) {
  return {stops, background, color};
}

/// Three pixels: empty, half covered by a grey of 0.25, and fully by it.
Film grey_film() {
  return row_film({{"A", {0, 0.5f, 1}},
                   {"B", {0, 0.125f, 0.25f}},
                   {"G", {0, 0.125f, 0.25f}},
                   {"R", {0, 0.125f, 0.25f}}});
}

TEST_F(Png, ThePictureIsExposedInStops) {
  // 0.25 is 137 on the sRGB curve, 0.5 is 188; highlights begin above 0.76.
  const auto middle = [&](float stops) {
    return shown(grey_film(), "", shown_as(stops, Background::color)).values.at(6);
  };
  EXPECT_EQ(middle(0), 137);
  EXPECT_EQ(middle(1), 188);
  EXPECT_LT(middle(2), 255) << "1 is below the highlights' limit";
  EXPECT_EQ(middle(12), 255);
}

TEST_F(Png, ABackgroundIsSeenWhereThePictureIsNot) {
  const Values over_red =
      shown(grey_film(), "", shown_as(1, Background::color, V3f(1, 0, 0))).values;
  EXPECT_EQ(over_red, (Values{255, 0, 0, 225, 137, 137, 188, 188, 188}));
  const Image alpha = shown(grey_film(), "", shown_as(1, Background::none));
  EXPECT_EQ(alpha.channels, 4);
  EXPECT_EQ(alpha.values, (Values{0, 0, 0, 0, 188, 188, 188, 128, 188, 188, 188, 255}));
  const Values sky = shown(grey_film(), "", shown_as(1, Background::sky)).values;
  EXPECT_GT(sky[2], sky[0]) << "blue";
  EXPECT_EQ(sky[6], 188);
}

TEST_F(Png, AutomaticExposureIsTheSameForEveryScaleOfLight) {
  Film film = grey_film();
  const Values once = shown(film).values;
  for (Plane& plane : film.planes)
    if (plane.channel != "A")
      for (float& value : plane.pixels) value *= 1000;
  EXPECT_EQ(shown(film).values, once);
  for (Plane& plane : film.planes) std::fill(plane.pixels.begin(), plane.pixels.end(), 0.0f);
  EXPECT_EQ(shown(film, "", {{}, Background::color, V3f(0, 0, 0)}).values, Values(9, 0));
}

/// A grey surface of one albedo, whose light is `light` in units of pi W/m2, with these alphas.
Film lit_film(const std::vector<float>& alphas, float albedo, float light) {
  std::vector<float> values, albedos(alphas.size(), albedo);
  for (const float alpha : alphas) values.push_back(alpha * albedo * light);
  std::vector<Plane> planes{{"A", alphas}};
  for (const char* channel : {"B", "G", "R"}) {
    planes.push_back({channel, values});
    planes.push_back({std::string("albedo.") + channel, albedos});
  }
  return row_film(planes);
}

TEST_F(Png, DarkSubjectsStayDarkerThanBrightOnes) {
  const auto shown_mean = [](float albedo) {
    const Film film = lit_film({1, 1, 1, 1}, albedo, 3);
    return albedo * 3 * automatic_exposure(film);
  };
  EXPECT_NEAR(shown_mean(0.5f), 0.35, 1e-5);
  EXPECT_NEAR(shown_mean(0.08f), 0.35 * 0.4, 1e-5) << "0.4: sqrt(0.08 / 0.5)";
  EXPECT_NEAR(shown_mean(1), 0.35 * std::sqrt(2), 1e-5);
}

TEST_F(Png, ThinCoverageCountsByItsAlphaForTheExposure) {
  const float whole = automatic_exposure(lit_film({1, 1}, 0.5f, 1e-4f));
  EXPECT_NEAR(automatic_exposure(lit_film({0.4f, 0.1f, 0}, 0.5f, 1e-4f)) / whole, 1, 1e-5);
  // A bright pixel that is hardly covered does not make the others dark.
  Film film = lit_film({1, 1, 0.01f}, 0.5f, 1);
  for (Plane& plane : film.planes)
    if (plane.channel.size() == 1 && plane.channel != "A") plane.pixels[2] *= 100;
  EXPECT_GT(automatic_exposure(film), 0.6f * automatic_exposure(lit_film({1, 1}, 0.5f, 1)));
}

TEST_F(Png, PixelsBeyondThePictureHaveAnExposureToo) {
  Film film = lit_film({1, 1, 1, 1}, 0.5f, 0.5f);
  const float inside = automatic_exposure(film);
  film.width = 2;
  film.data_window = {-1, -3, 2, -3};
  EXPECT_NEAR(automatic_exposure(film), inside, 1e-4f * inside);
}

TEST_F(Png, TheMiddleCountsMoreForTheExposure) {
  Film dark_edges = lit_film({1, 1, 1}, 0.5f, 0.5f), dark_middle = dark_edges;
  for (std::size_t p = 0; p < 3; ++p)
    for (Film* film : {&dark_edges, &dark_middle})
      for (Plane& plane : film->planes)
        if (plane.channel.size() == 1 && plane.channel != "A" && (p == 1) == (film == &dark_middle))
          plane.pixels[p] *= 0.1f;
  EXPECT_GT(automatic_exposure(dark_middle), 2 * automatic_exposure(dark_edges));
}

// The camera looks down by 45 degrees with a field of view of 90: the upper edge is the horizon.
TEST_F(Png, TheHorizonOfTheBackgroundIsTheCameras) {
  Film film;
  film.width = film.height = 64;
  const float c = std::sqrt(0.5f);
  // Columns: right, up, forward of OpenEXR's camera.
  film.metadata.world_to_camera = M44f(1, 0, 0, 0, 0, c, -c, 0, 0, c, c, 0, 0, 0, 0, 1);
  const M44f projection(0.5f, 0, 0, 0, 0, -0.5f, 0, 0, 0.5f, 0.5f, 1, 1, 0, 0, 0, 0);
  film.metadata.world_to_ndc = film.metadata.world_to_camera * projection;
  const PixelElevation elevation(film);
  EXPECT_NEAR(elevation.sine(32, 0), 0, 1e-6);
  EXPECT_NEAR(elevation.sine(32, 32), -c, 1e-6);
  EXPECT_NEAR(elevation.sine(32, 64), -1, 1e-6) << "straight down";
  EXPECT_NEAR(elevation.sine(0, 32), -c / std::sqrt(2.0f), 1e-6);
  film.metadata.world_to_ndc = film.metadata.world_to_camera *
                               M44f(0.5f, 0, 0, 0, 0, -0.5f, 0, 0, 0, 0, 1, 0, 0.5f, 0.5f, 0, 1);
  EXPECT_NEAR(PixelElevation(film).sine(0, 0), -c, 1e-6) << "parallel rays";
}

TEST_F(Png, HighlightsBecomeWhiteInOrderAndDarkerColoursStay) {
  EXPECT_EQ(tone_mapped(V3f(0.7f, 0.2f, 0)), V3f(0.7f, 0.2f, 0));
  V3f before(0, 0, 0);
  for (float value = 0.01f; value < 1e6f; value *= 1.1f) {
    const V3f mapped = tone_mapped(V3f(value, 0.5f * value, 0.1f * value));
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_GE(mapped[channel], before[channel]);
      EXPECT_LE(mapped[channel], 1.0f);
    }
    before = mapped;
  }
  EXPECT_GT(before.z, 0.99f);
  EXPECT_EQ(tone_mapped(V3f(kNan, -1, 0.5f)), V3f(0, 0, 0.5f));
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

TEST_F(Png, ExposuresBackgroundsAndColoursOutsideTheirRangesAreRefused) {
  const Film film = row_film({{"R", {1}}, {"G", {1}}, {"B", {1}}, {"A", {1}}});
  for (const PngOptions& options :
       {PngOptions{kNan, Background::sky, V3f(0)}, PngOptions{kInfinity, Background::sky, V3f(0)},
        PngOptions{-101.0f, Background::sky, V3f(0)},
        PngOptions{0.0f, static_cast<Background>(3), V3f(0)},
        PngOptions{0.0f, Background::color, V3f(0, kNan, 0)},
        PngOptions{0.0f, Background::color, V3f(0, 0, 1.5f)}}) {
    const Error error = error_of([&] { write_png(film, path("a.png"), "", options); });
    EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
  }
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
