// Dome images whose radiance is beyond what a light may have are refused with the pixel, so that no
// picture has infinite pixels.
#include <gtest/gtest.h>

#include "dapple/render.hpp"
#include "scene/images/dome_image.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

class DomeRange : public FilmFile {
 protected:
  /// A Radiance image of 2 x 1 pixels with these exponents.
  [[nodiscard]] std::string radiance_file(int first, int second) const {
    std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    for (const int exponent : {first, second}) {
      bytes += std::string(3, '\x80');
      bytes += static_cast<char>(exponent);
    }
    write_bytes(path("a.hdr"), bytes);
    return path("a.hdr");
  }
  [[nodiscard]] std::string exr_file(float value) const {
    Film film;
    film.width = 2;
    film.height = 1;
    film.data_window = {0, 0, 1, 0};
    for (const char* channel : {"R", "G", "B"}) film.planes.push_back({channel, {1, value}});
    write_exr(film, path("a.exr"));
    return path("a.exr");
  }
};

TEST_F(DomeRange, PixelsThatNoLightMayHaveAreRefused) {
  EXPECT_TRUE(contains(error_of([&] { load_environment(radiance_file(129, 255)); }).what(),
                       "a.hdr: pixel 1, 0 is 8.51e+37, above 1e+30"));
  EXPECT_TRUE(contains(error_of([&] { load_environment(exr_file(3e38f)); }).what(),
                       "a.exr: pixel 1, 0 is 3e+38, above 1e+30"));
}

TEST_F(DomeRange, TheBrightestDomeMakesAFinitePicture) {
  Scene scene = make_procedural("scene:cube");
  Light light;
  light.name = "dome";
  light.kind = LightKind::dome;
  light.environment = load_environment(exr_file(1e30f));
  scene.lights = {light};
  RenderOptions options;
  options.width = options.height = 16;
  options.spp = 4;
  const RenderResult result = render(scene, options);
  for (const Plane& plane : result.film.planes) {
    if (plane.channel == "Z") continue;
    for (const float pixel : plane.pixels) EXPECT_TRUE(std::isfinite(pixel)) << plane.channel;
  }
  scene.lights[0].radiance = V3f(100);
  EXPECT_TRUE(contains(error_of([&] { render(scene, options); }).what(),
                       "a.exr: the dome's mean radiance is "));
}

TEST_F(DomeRange, NegativeRadianceCountsAsZeroAndIsNamed) {
  Scene scene;
  Light light;
  light.kind = LightKind::dome;
  light.environment = load_environment(exr_file(-2));
  EXPECT_EQ(light.environment->negative_pixels, 1u);
  EXPECT_EQ(light.environment->radiance[1], V3f(0));
  scene.lights = {light};
  finalize_domes(scene);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(
      contains(scene.warnings[0], "a.exr: pixels with negative radiance: 1; it counts as 0"));
}

// As compositors write them that trim black borders.
TEST_F(DomeRange, AnImageThatIsAPartOfItsDisplayWindowIsNamed) {
  Light light;
  light.kind = LightKind::dome;
  light.environment = load_environment(exr_file(2));
  EXPECT_FALSE(light.environment->is_cropped);
  Film film = read_exr(path("a.exr"));
  film.width = 4;
  film.height = 2;
  write_exr(film, path("a.exr"));
  light.environment = load_environment(path("a.exr"));
  Scene scene;
  scene.lights = {light};
  finalize_domes(scene);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(contains(scene.warnings[0], "a.exr: its data window, which is not its display"));
}

TEST_F(DomeRange, ImagesThatAreNotTwiceAsWideAsHighAreNamed) {
  for (const bool is_square : {false, true}) {
    Scene scene;
    Light light;
    light.kind = LightKind::dome;
    Environment image{4, is_square ? 4u : 2u, std::vector<V3f>(is_square ? 16 : 8, V3f(1)),
                      "a.exr"};
    light.environment = std::make_shared<const Environment>(image);
    scene.lights = {light};
    finalize_domes(scene);
    ASSERT_EQ(scene.warnings.size(), is_square ? 1u : 0u);
    if (is_square) {
      EXPECT_TRUE(contains(scene.warnings[0], "a.exr: it is not twice as wide as high"));
    }
  }
}

}  // namespace
}  // namespace dapple
