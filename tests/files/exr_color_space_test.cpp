// Colour spaces of EXR files: conversions to BT.709 against published matrices.
#include "files/exr_color_space.hpp"

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "scene/images/dome_image.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using Imath::V2f;
using Imath::V3f;

/// Those of ACES2065-1.
Imf::Chromaticities aces() {
  return {V2f(0.7347f, 0.2653f), V2f(0, 1), V2f(0.0001f, -0.077f), V2f(0.32168f, 0.33767f)};
}

Imf::Header header_with(const Imf::Chromaticities& chromaticities) {
  Imf::Header header;
  Imf::addChromaticities(header, chromaticities);
  return header;
}

TEST(ExrColorSpace, WithoutChromaticitiesOrWithThoseOfBt709NothingChanges) {
  EXPECT_EQ(to_bt709(Imf::Header()), Imath::M33f());
  EXPECT_EQ(to_bt709(header_with({})), Imath::M33f());
}

// The matrix of ACES2065-1 to linear sRGB, adapted by the Bradford method, as colour libraries
// print it.
TEST(ExrColorSpace, AcesIsConvertedAndItsWhiteStaysWhite) {
  const Imath::M33f matrix = to_bt709(header_with(aces()));
  const float rows[3][3] = {
      {2.5217f, -1.1341f, -0.3876f}, {-0.2765f, 1.3727f, -0.0962f}, {-0.0154f, -0.1530f, 1.1684f}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      EXPECT_NEAR(matrix[column][row], rows[row][column], 5e-4) << row << ", " << column;
  EXPECT_TRUE((V3f(2, 2, 2) * matrix).equalWithAbsError(V3f(2, 2, 2), 1e-4f));
}

TEST(ExrColorSpace, PrimariesOnALineHaveNoMatrix) {
  const V2f one(0.3f, 0.3f);
  EXPECT_FALSE(std::isfinite(to_bt709(header_with({one, one, one, one})).determinant()));
}

class ExrDome : public film_test::FilmFile {
 protected:
  /// A dome of 2 x 1 pixels of this colour.
  [[nodiscard]] std::string written(Imf::Header header, const V3f& color) const {
    std::vector<float> channels[3];
    Imf::FrameBuffer buffer;
    for (int c = 0; c < 3; ++c) {
      channels[c] = {color[c], color[c]};
      const char name[] = {"RGB"[c], 0};
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, channels[c].data(), header.dataWindow()));
    }
    Imf::OutputFile file(path("dome.exr").c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(1);
    return path("dome.exr");
  }
};

TEST_F(ExrDome, IsConvertedByItsChromaticities) {
  Imf::Header header(2, 1);
  const V3f color(0.5f, 0.4f, 0.3f);
  EXPECT_EQ(load_environment(written(header, color))->radiance.at(1), color);
  Imf::addChromaticities(header, aces());
  const V3f expected = color * to_bt709(header);
  EXPECT_GT((expected - color).length(), 0.1f);
  EXPECT_LT((load_environment(written(header, color))->radiance.at(1) - expected).length(), 1e-6f);
}

TEST_F(ExrDome, OfTheSidesOfACubeOrOfPrimariesOnALineIsRefused) {
  Imf::Header cube(2, 1), line(2, 1);
  Imf::addEnvmap(cube, Imf::ENVMAP_CUBE);
  const V2f one(0.3f, 0.3f);
  Imf::addChromaticities(line, {one, one, one, one});
  EXPECT_TRUE(film_test::contains(
      film_test::error_of([&] { load_environment(written(cube, V3f(1, 1, 1))); }).what(),
      "dome.exr: shows the sides of a cube"));
  EXPECT_TRUE(film_test::contains(
      film_test::error_of([&] { load_environment(written(line, V3f(1, 1, 1))); }).what(),
      "dome.exr: has chromaticities without an area"));
}

TEST(ExrColorSpace, CubeMapsAreToldFromLatitudeAndLongitude) {
  Imf::Header header;
  EXPECT_FALSE(is_cube_map(header));
  Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  EXPECT_FALSE(is_cube_map(header));
  Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  EXPECT_TRUE(is_cube_map(header));
}

}  // namespace
}  // namespace dapple
