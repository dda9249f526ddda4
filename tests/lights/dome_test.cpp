// Dome lights against closed forms: the irradiance of a grey dome is pi times AO, and one bright
// texel acts as a sun. Also tests the readers of Radiance HDR and EXR images.
#include <algorithm>
#include <fstream>

#include "dapple/error.hpp"
#include "dapple/film.hpp"
#include "scene/images/color.hpp"
#include "scene/images/dome_image.hpp"
#include "scene/images/dome_rows.hpp"
#include "scene/images/radiance_hdr.hpp"
#include "support/files/film_files.hpp"
#include "support/scenes/point_on_ground.hpp"

namespace dapple {
namespace {

using namespace point_on_ground_test;

Light dome(std::shared_ptr<const Environment> environment = nullptr, float rotation = 0) {
  Light light;
  light.name = "dome";
  light.kind = LightKind::dome;
  light.environment = std::move(environment);
  light.rotation = rotation;
  return light;
}

/// A black image with one texel of `radiance`.
std::shared_ptr<Environment> one_texel(std::uint32_t width, std::uint32_t height, std::uint32_t x,
                                       std::uint32_t y, V3f radiance) {
  auto image = std::make_shared<Environment>(Environment{width, height, {}});
  image->radiance.assign(std::size_t{width} * height, V3f(0.0f));
  image->radiance[std::size_t{y} * width + x] = radiance;
  return image;
}

/// Integral of the cosine to +Y over a texel of row `y`, which must be above the horizon.
double texel_cosine(const Environment& image, std::uint32_t y) {
  const auto sine_square = [&](double row) {
    return std::pow(std::sin(kPi * row / image.height), 2);
  };
  return kPi / image.width * (sine_square(y + 1) - sine_square(y));
}

V3d irradiance(const Scene& scene, const RenderOptions& options = one_pixel()) {
  const Film film = render(scene, options).film;
  return {value(film, "light.dome.R"), value(film, "light.dome.G"), value(film, "light.dome.B")};
}

TEST(Dome, IrradianceOfAGreyDomeIsPiTimesAmbientOcclusion) {
  Scene scene = point_on_ground();
  place(scene, square_mesh(1, 0.4f, 1, 0));
  scene.instances.back().to_world.setTranslation(V3f(0.6f, 0, 0));
  scene.lights.push_back(dome());
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const Film film = render(scene, one_pixel(estimator)).film;
    const double ao = value(film, "ao.R");
    ASSERT_LT(ao, 0.9);
    EXPECT_NEAR(value(film, "light.dome.G"), kPi * ao, kPi * kSampling);
  }
}

TEST(Dome, AnImageOfOneColourIsThatColour) {
  Scene scene = point_on_ground();
  auto image = std::make_shared<Environment>(Environment{8, 4, {}});
  image->radiance.assign(32, V3f(3, 2, 0.5f));
  scene.lights.push_back(dome(image));
  scene.lights[0].radiance = V3f(1, 2, 4);
  const V3d found = irradiance(scene);
  EXPECT_NEAR(found.x, 3 * kPi, 3 * kPi * kSampling);
  EXPECT_NEAR(found.y, 4 * kPi, 4 * kPi * kSampling);
  EXPECT_NEAR(found.z, 2 * kPi, 2 * kPi * kSampling);
}

TEST(Dome, OneBrightTexelGivesTheIntegralOfItsCosine) {
  Scene scene = point_on_ground();
  const auto image = one_texel(64, 32, 20, 5, V3f(500, 1000, 0));
  scene.lights.push_back(dome(image));
  const double expected = texel_cosine(*image, 5);
  const V3d found = irradiance(scene);
  // Half of the rays are cosine-weighted and almost never hit the texel.
  EXPECT_NEAR(found.x, 500 * expected, 500 * expected * 0.01);
  EXPECT_NEAR(found.y, 1000 * expected, 1000 * expected * 0.01);
  EXPECT_EQ(found.z, 0);
}

/// 0 if a square at `offset` shades the point from one bright texel at 45 degrees above the
/// horizon, 1 if not.
double lit(std::uint32_t column, float rotation, V3f offset) {
  Scene scene = point_on_ground();
  place(scene, square_mesh(0.6f, 0, 1, 0));
  scene.instances.back().to_world.setTranslation(offset);
  const auto image = one_texel(64, 32, column, 8, V3f(100, 100, 100));
  scene.lights.push_back(dome(image, rotation));
  return irradiance(scene).y / (100 * texel_cosine(*image, 8));
}

TEST(Dome, TheMiddleColumnIsPlusZAndAQuarterIsPlusX) {
  EXPECT_NEAR(lit(32, 0, {0, 1, 1}), 0, 0.01);
  EXPECT_NEAR(lit(32, 0, {0, 1, -1}), 1, 0.02);
  EXPECT_NEAR(lit(16, 0, {1, 1, 0}), 0, 0.01);
  EXPECT_NEAR(lit(16, 0, {-1, 1, 0}), 1, 0.02);
}

TEST(Dome, RotationTurnsWhatLiesAlongPlusZTowardsPlusX) {
  const auto quarter = static_cast<float>(kPi / 2);
  EXPECT_NEAR(lit(32, quarter, {1, 1, 0}), 0, 0.01);
  EXPECT_NEAR(lit(32, quarter, {0, 1, 1}), 1, 0.02);
  EXPECT_NEAR(lit(16, -quarter, {0, 1, 1}), 0, 0.01);
}

double rmse(const Film& a, const Film& b, const char* plane) {
  const std::vector<float>&of_a = a.find(plane)->pixels, &of_b = b.find(plane)->pixels;
  double sum = 0;
  for (std::size_t p = 0; p < of_a.size(); ++p) sum += std::pow(of_a[p] - of_b[p], 2);
  return std::sqrt(sum / static_cast<double>(of_a.size()));
}

// Both pictures use the same samples, so most of their noise is the same.
TEST(Dome, PicturesOfATreeComeNearerToExactAsTheFootprintShrinks) {
  Scene scene = make_procedural("scene:tree?leaves=2000");
  auto image = std::make_shared<Environment>(Environment{16, 8, {}});
  for (int texel = 0; texel < 16 * 8; ++texel)
    image->radiance.emplace_back(texel < 64 ? 1.0f + static_cast<float>(texel % 3) : 0.2f);
  scene.lights = {dome(image)};
  RenderOptions options;
  options.width = options.height = 48;
  options.spp = 16;
  options.ao = false;
  options.estimator = Estimator::exact;
  options.roulette = 0;
  const Film exact = render(scene, options).film;
  options.estimator = Estimator::prefiltered;
  double last = 1e9;
  for (const float footprint : {16.0f, 1.0f, 1.0f / 16, 1.0f / 256}) {
    options.footprint = footprint;
    const double now = rmse(render(scene, options).film, exact, "light.dome.G");
    EXPECT_LT(now, 0.9 * last) << footprint;
    last = now;
  }
  EXPECT_LT(last, 0.02);
}

TEST(Dome, FinalizingKeepsIrradianceAndMakesTheMeanLuminanceOne) {
  Scene scene = point_on_ground();
  auto image = std::make_shared<Environment>(Environment{6000, 3, {}});
  for (std::uint32_t y = 0; y < 3; ++y)
    for (std::uint32_t x = 0; x < 6000; ++x) image->radiance.emplace_back(x < 3000 ? 8 : 2, y, 1);
  scene.lights.push_back(dome(image));
  finalize_domes(scene);
  const Light& light = scene.lights[0];
  ASSERT_TRUE(light.environment);
  EXPECT_LE(light.environment->width, 2048u);
  double mean = 0, red = 0, weights = 0;
  for (std::uint32_t y = 0; y < light.environment->height; ++y) {
    for (std::uint32_t x = 0; x < light.environment->width; ++x) {
      const double weight = texel_solid_angle(*light.environment, y);
      mean += weight * luminance(texel(*light.environment, x, y));
      red += weight * texel(*light.environment, x, y).x * light.radiance.x;
      weights += weight;
    }
  }
  EXPECT_NEAR(mean / weights, 1, 1e-5);
  EXPECT_NEAR(red / weights, 5, 1e-3);
}

TEST(Dome, BlackImagesGiveNoLight) {
  Scene scene = point_on_ground();
  scene.lights.push_back(dome(one_texel(4, 2, 0, 0, V3f(0.0f))));
  EXPECT_EQ(irradiance(scene), V3d(0.0));
}

TEST(Dome, SamplesSplitAmongRaysConvergeToTheSameAdaptively) {
  Scene scene = point_on_ground();
  scene.lights.push_back(dome(one_texel(16, 8, 3, 1, V3f(50, 20, 10))));
  RenderOptions options = one_pixel();
  options.light_rays = 4;
  options.spp = 4;
  options.max_spp = 4096;
  options.target_error = 0.005f;
  const double expected = 20 * texel_cosine(*scene.lights[0].environment, 1);
  EXPECT_NEAR(irradiance(scene, options).y, expected, 0.03 * expected);
}

std::vector<std::uint8_t> hdr_bytes(const std::string& header, std::initializer_list<int> pixels) {
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  for (const int value : pixels) bytes.push_back(static_cast<std::uint8_t>(value));
  return bytes;
}

// Two rows of eight pixels: the first has one run in each channel, the second also stored values.
std::vector<std::uint8_t> small_hdr() {
  return hdr_bytes("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n",
                   {2, 2, 0, 8, 136, 128, 136, 64, 136, 32, 136, 129,  //
                    2, 2, 0, 8, 8,   1,   2,   3,  4,   5,  6,   7,   8, 136, 0, 136, 0, 136, 136});
}

TEST(RadianceHdr, RunsAndStoredScanlinesAreRead) {
  const std::vector<std::uint8_t> bytes = small_hdr();
  const RadianceImage image(bytes, "small.hdr");
  ASSERT_EQ(image.width(), 8u);
  ASSERT_EQ(image.height(), 2u);
  const std::vector<V3f> pixels = image.rows(0, 2);
  EXPECT_EQ(pixels[5], V3f(1, 0.5f, 0.25f));
  EXPECT_EQ(pixels[8 + 2], V3f(3, 0, 0));
  EXPECT_EQ(image.rows(1, 1), std::vector<V3f>(pixels.begin() + 8, pixels.end()));
}

TEST(RadianceHdr, PixelsThatAreNotEncodedAreRead) {
  const std::vector<std::uint8_t> bytes =
      hdr_bytes("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 1\n",
                {128, 64, 32, 129, 1, 2, 3, 0, 255, 0, 1, 137});
  const RadianceImage image(bytes, "flat.hdr");
  EXPECT_EQ(image.rows(0, 3), (std::vector<V3f>{V3f(1, 0.5f, 0.25f), V3f(0.0f), V3f(510, 0, 2)}));
  EXPECT_EQ(image.rows(2, 1), std::vector<V3f>{V3f(510, 0, 2)});
}

TEST(RadianceHdr, DamagedFilesAreRefusedAtEveryLength) {
  const std::vector<std::uint8_t> whole = small_hdr();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(RadianceImage(std::span(whole).first(size), "cut.hdr"), Error) << size;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::vector<std::uint8_t> changed = whole;
    changed[at] = 0;
    try {
      const RadianceImage image(changed, "changed.hdr");
      (void)image.rows(0, image.height());
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
    }
  }
}

class LoadEnvironment : public film_test::FilmFile {};

TEST_F(LoadEnvironment, ReadsExrChannelsAndRefusesInvalidFiles) {
  Film film;
  film.width = 2;
  film.height = 1;
  film.data_window = {0, 0, 1, 0};
  for (const char* channel : {"R", "G", "B"})
    film.planes.push_back({channel, {static_cast<float>(channel[0]), -1}});
  write_exr(film, path("sky.exr"));
  const auto image = load_environment(path("sky.exr"));
  EXPECT_EQ(image->radiance[0], V3f('R', 'G', 'B'));
  EXPECT_EQ(image->radiance[1], V3f(0.0f));

  film.planes[1].pixels[1] = std::numeric_limits<float>::infinity();
  write_exr(film, path("hot.exr"));
  EXPECT_THROW((void)load_environment(path("hot.exr")), Error);
  std::ofstream(path("not.hdr")) << "P6 1 1 255 abc";
  EXPECT_THROW((void)load_environment(path("not.hdr")), Error);
  EXPECT_THROW((void)load_environment(path("none.hdr")), Error);
}

TEST_F(LoadEnvironment, LargeExrImagesAreReadStripByStrip) {
  Film film;
  film.width = 3;
  film.height = 2051;
  film.data_window = {0, 0, film.width - 1, film.height - 1};
  DomeRows dome(3, 2051);
  std::vector<V3f> pixels;
  for (int i = 0; i < 3 * 2051; ++i) {
    const float value = static_cast<float>(i % 97);
    pixels.emplace_back(value, 2 * value, 3 * value);
  }
  for (const int channel : {0, 1, 2}) {
    Plane plane{std::string(1, "RGB"[channel]), {}};
    for (const V3f& pixel : pixels) plane.pixels.push_back(pixel[channel]);
    film.planes.push_back(std::move(plane));
  }
  write_exr(film, path("tall.exr"));
  const auto image = load_environment(path("tall.exr"));
  dome.add(dome.strips(2051).front(), pixels);
  EXPECT_EQ(image->radiance, dome.take("tall.exr").radiance);
  EXPECT_EQ(image->height, 683u);
}

TEST_F(LoadEnvironment, RadianceImagesAreReadStripByStrip) {
  constexpr int kRows = 40;
  std::vector<std::uint8_t> bytes =
      hdr_bytes("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 40 +X 8\n", {});
  for (int row = 0; row < kRows; ++row) {
    const std::vector<std::uint8_t> line =
        hdr_bytes("", {2, 2, 0, 8, 136, row, 136, 2 * row, 136, 0, 136, 136});
    bytes.insert(bytes.end(), line.begin(), line.end());
  }
  std::ofstream(path("rows.hdr"), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  const auto image = load_environment(path("rows.hdr"));
  for (std::uint32_t row = 0; row < kRows; ++row) {
    const auto value = static_cast<float>(row);
    EXPECT_EQ(texel(*image, 7, row), V3f(value, 2 * value, 0)) << row;
  }
}

}  // namespace
}  // namespace dapple
