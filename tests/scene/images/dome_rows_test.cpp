// Images of domes that are added strip by strip: the result does not depend on the strips, and
// pixels that no light may have are named.
#include "scene/images/dome_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <span>

#include "dapple/error.hpp"
#include "scene/images/dome_image.hpp"

namespace dapple {
namespace {

/// Three columns; 2,051 rows become 683: each is the mean of a little more than three.
constexpr std::uint32_t kWidth = 3, kHeight = 2051, kDown = 3;

std::vector<V3f> random_image(std::uint32_t width, std::uint32_t height) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(0, 10);
  std::vector<V3f> pixels(std::size_t{width} * height);
  for (V3f& pixel : pixels) pixel = V3f(value(random), value(random), value(random));
  return pixels;
}

/// Adds the image in strips of about `rows`, the last strip first.
Environment added(const std::vector<V3f>& pixels, std::uint32_t width, std::uint32_t height,
                  std::uint32_t rows) {
  DomeRows dome(width, height);
  std::vector<DomeRows::Strip> strips = dome.strips(rows);
  std::reverse(strips.begin(), strips.end());
  for (const DomeRows::Strip& strip : strips)
    dome.add(strip, std::span(pixels).subspan(std::size_t{strip.first} * width,
                                              std::size_t{strip.count} * width));
  return dome.take("sky.exr");
}

TEST(DomeRows, RowsOfTheResultAreMeansWeightedBySolidAngle) {
  const std::vector<V3f> pixels = random_image(kWidth, kHeight);
  const Environment image = added(pixels, kWidth, kHeight, 64);
  ASSERT_EQ(image.width, kWidth);
  ASSERT_EQ(image.height, kHeight / kDown);
  for (const std::uint32_t row : {0u, 400u, image.height - 1}) {
    const double size = double{kHeight} / image.height, begin = row * size, end = begin + size;
    V3d sum(0.0);
    double weights = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y) {
      const double part = std::min(end, y + 1.0) - std::max(begin, 1.0 * y);
      if (part <= 0) continue;
      const double weight = part * texel_solid_angle(kWidth, kHeight, y);
      sum += V3d(pixels[y * kWidth + 1]) * weight;
      weights += weight;
    }
    EXPECT_LT((V3d(texel(image, 1, row)) - sum / weights).length(), 1e-5) << row;
  }
}

// 5,000 columns become 1,666: a sun of one pixel is as bright wherever it stands.
TEST(DomeRows, ABrightPixelKeepsItsEnergyInEveryColumn) {
  constexpr std::uint32_t kColumns = 5000, kRows = 3;
  for (const std::uint32_t column : {0u, 1u, 2u, 3u, 2500u, 4997u, 4998u, 4999u}) {
    std::vector<V3f> pixels(std::size_t{kColumns} * kRows, V3f(0, 0, 0));
    pixels[kColumns + column] = V3f(1000, 0, 0);
    const Environment image = added(pixels, kColumns, kRows, 1);
    double sum = 0;
    for (std::uint32_t x = 0; x < image.width; ++x)
      sum += double{texel(image, x, 1).x} / image.width;
    EXPECT_NEAR(sum, 1000.0 / kColumns, 1e-5) << column;
  }
}

// The last rows once had what was left after whole boxes: light from the nadir lost more than half.
TEST(DomeRows, ABrightPixelKeepsItsEnergyInEveryRow) {
  for (const std::uint32_t rows : {1025u, 1501u, kHeight, 3071u})
    for (const std::uint32_t row : {0u, 1u, 2u, rows / 2, rows - 3, rows - 2, rows - 1}) {
      std::vector<V3f> pixels(rows, V3f(0, 0, 0));
      pixels[row] = V3f(1000, 0, 0);
      const Environment image = added(pixels, 1, rows, 64);
      double sum = 0;
      for (std::uint32_t y = 0; y < image.height; ++y)
        sum += double{texel(image, 0, y).x} * texel_solid_angle(1, image.height, y);
      EXPECT_NEAR(sum / (1000 * texel_solid_angle(1, rows, row)), 1, 0.005)
          << row << " of " << rows;
    }
}

TEST(DomeRows, TheResultDoesNotDependOnTheStrips) {
  for (const auto& [width, height] : {std::pair{3u, 2051u}, {5000u, 7u}, {4u, 2u}, {3u, 2049u}}) {
    const std::vector<V3f> pixels = random_image(width, height);
    const Environment whole = added(pixels, width, height, height);
    for (const std::uint32_t rows : {1u, 16u, 100u})
      EXPECT_EQ(added(pixels, width, height, rows).radiance, whole.radiance)
          << width << " x " << height << " by " << rows;
  }
}

TEST(DomeRows, SmallImagesStayAsTheyAreButForNegativeValues) {
  std::vector<V3f> pixels = random_image(4, 2);
  pixels[5] = V3f(1, -2, 3);
  pixels[6] = V3f(-1, -2, -3);
  const Environment image = added(pixels, 4, 2, 1);
  pixels[5] = V3f(1, 0, 3);
  pixels[6] = V3f(0.0f);
  EXPECT_EQ(image.radiance, pixels);
  EXPECT_EQ(image.negative_pixels, 2u);
}

TEST(DomeRows, TheFirstPixelThatNoLightMayHaveIsNamed) {
  std::vector<V3f> pixels = random_image(kWidth, kHeight);
  pixels[2000 * kWidth + 1].y = 3e38f;
  pixels[100 * kWidth + 2].x = std::numeric_limits<float>::infinity();
  const auto reason = [&] {
    try {
      (void)added(pixels, kWidth, kHeight, 16);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(reason(), "sky.exr: pixel 2, 100 is not finite");
  pixels[100 * kWidth + 2].x = 1;
  EXPECT_EQ(reason(), "sky.exr: pixel 1, 2000 is 3e+38, above 1e+30");
}

}  // namespace
}  // namespace dapple
