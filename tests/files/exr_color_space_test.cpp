// Colour spaces of EXR files: conversions to BT.709 against published matrices.
#include "files/exr_color_space.hpp"

#include <ImfChromaticities.h>
#include <ImfEnvmap.h>
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dapple {
namespace {

using Imath::V2f;
using Imath::V3f;

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
  const Imath::M33f matrix = to_bt709(header_with(
      {V2f(0.7347f, 0.2653f), V2f(0, 1), V2f(0.0001f, -0.077f), V2f(0.32168f, 0.33767f)}));
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
