// Opacities at depths: sums of samples, pictures of surfaces whose depths and opacities are known,
// and deep files, read with OpenEXR's own reader.
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputFile.h>
#include <ImfPartType.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "film/sums/deep_sums.hpp"
#include "support/files/film_files.hpp"
#include "support/programs/program_run.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

using Samples = std::vector<DeepAlpha::Sample>;

Samples of_pixel(const DeepAlpha& deep, std::size_t pixel) {
  return {deep.samples.begin() + static_cast<std::ptrdiff_t>(deep.first.at(pixel)),
          deep.samples.begin() + static_cast<std::ptrdiff_t>(deep.first.at(pixel + 1))};
}

/// The samples composited over each other.
double flattened(const Samples& samples) {
  double through = 1;
  for (const DeepAlpha::Sample& sample : samples) through *= 1 - double{sample.alpha};
  return 1 - through;
}

TEST(DeepSums, SharesOfSamplesBecomeAlphasFrontToBack) {
  DeepSums sums(3);
  for (const float z : {5.0f, 2.0f, 5.001f, 9.0f, 2.0f, 5.0f}) sums.add(1, z);
  sums.add(2, 1);
  const DeepAlpha deep = sums.alpha({8, 8, 1});
  EXPECT_TRUE(of_pixel(deep, 0).empty());
  const Samples samples = of_pixel(deep, 1);
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_EQ(samples[0].z, 2);
  EXPECT_FLOAT_EQ(samples[0].alpha, 2 / 8.0f);
  EXPECT_NEAR(samples[1].z, 5.00033f, 1e-4f);
  EXPECT_FLOAT_EQ(samples[1].alpha, 3 / 6.0f);
  EXPECT_EQ(samples[2].z, 9);
  EXPECT_FLOAT_EQ(samples[2].alpha, 1 / 3.0f);
  EXPECT_NEAR(flattened(samples), 6 / 8.0, 1e-7);
  ASSERT_EQ(of_pixel(deep, 2).size(), 1u);
  EXPECT_EQ(of_pixel(deep, 2)[0].alpha, 1);
}

TEST(DeepSums, MoreDepthsThanFitAreMergedAtTheirNearest) {
  DeepSums sums(1);
  const auto depth = [](std::size_t i) { return i == 7 ? 6.1f : static_cast<float>(i); };
  for (std::size_t i = kMaxDeepSamples + 1; i > 0; --i) sums.add(0, depth(i));
  const Samples samples = of_pixel(sums.alpha({100}), 0);
  ASSERT_EQ(samples.size(), kMaxDeepSamples);
  for (std::size_t i = 1; i < samples.size(); ++i) EXPECT_LT(samples[i - 1].z, samples[i].z);
  EXPECT_FLOAT_EQ(samples[5].z, 6.05f);
  EXPECT_FLOAT_EQ(samples[5].alpha, 2 / 95.0f);
  EXPECT_NEAR(flattened(samples), 0.17, 1e-6);
}

TEST(DeepSums, MergedDepthsAreTheMeanOfTheirSamples) {
  DeepSums sums(1);
  for (int i = 0; i < 3; ++i) sums.add(0, 6.1f);
  for (std::size_t i = kMaxDeepSamples; i > 0; --i) sums.add(0, static_cast<float>(i));
  const Samples samples = of_pixel(sums.alpha({100}), 0);
  ASSERT_EQ(samples.size(), kMaxDeepSamples);
  EXPECT_FLOAT_EQ(samples[5].z, (6 + 3 * 6.1f) / 4);
  EXPECT_FLOAT_EQ(samples[5].alpha, 4 / 95.0f);
}

/// Squares of opacity 1/4, 1/2 and 1 before the camera, at 4, 5 and 8 m; the last is half as wide.
Scene three_squares() {
  Scene scene;
  for (const auto& [z, opacity, width] :
       {std::tuple(-4.0f, 0.25f, 8.0f), {-5.0f, 0.5f, 8.0f}, {-8.0f, 1.0f, 4.0f}}) {
    scene.materials.push_back(material_of(opacity));
    Mesh square;
    append_grid(square, {-4, -4, z}, {width, 0, 0}, {0, 8, 0}, 1,
                static_cast<std::uint32_t>(scene.materials.size() - 1));
    place(scene, std::move(square));
  }
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 2;
  scene.cameras.push_back(camera);
  return scene;
}

RenderOptions small_picture() {
  RenderOptions options;
  options.width = 16;
  options.height = 8;
  options.spp = 256;
  options.ao = options.light = false;
  options.deep = true;
  return options;
}

void expect_alphas(const Samples& samples, const std::vector<DeepAlpha::Sample>& expected,
                   double tolerance) {
  ASSERT_EQ(samples.size(), expected.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(samples[i].z, expected[i].z, 1e-4);
    EXPECT_NEAR(samples[i].alpha, expected[i].alpha, tolerance);
  }
}

TEST(DeepAlpha, OfSquaresHasTheirDepthsAndOpacities) {
  for (const int splitting : {1, 4}) {
    RenderOptions options = small_picture();
    options.camera_splitting = splitting;
    const DeepAlpha deep = render(three_squares(), options).film.deep;
    ASSERT_EQ(deep.first.size(), 129u);
    // 256 stratified thresholds; of the fewer that pass, the error is larger.
    for (std::size_t p = 0; p < 128; ++p)
      expect_alphas(
          of_pixel(deep, p),
          p % 16 < 8 ? Samples{{4, 0.25f}, {5, 0.5f}, {8, 1}} : Samples{{4, 0.25f}, {5, 0.5f}},
          0.03);
  }
}

TEST(DeepAlpha, FlattenedIsTheAlphaLayer) {
  Scene scene = make_procedural("scene:tree?leaves=2000");
  override_opacity(scene, "leaf", 0.4f);
  RenderOptions options = small_picture();
  options.width = 64;
  options.height = 48;
  options.spp = 37;
  const Film film = render(scene, options).film;
  std::size_t most = 0;
  for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
    const Samples samples = of_pixel(film.deep, p);
    EXPECT_NEAR(flattened(samples), film.find("A")->pixels[p], 1e-5) << p;
    for (std::size_t i = 1; i < samples.size(); ++i) EXPECT_LT(samples[i - 1].z, samples[i].z);
    most = std::max(most, samples.size());
  }
  EXPECT_GT(most, 5u);
  options.deep = false;
  EXPECT_TRUE(render(scene, options).film.deep.first.empty());
}

TEST(DeepAlpha, AnOpenShutterHasTheDepthsOfItsMoments) {
  const auto scene_at = [](int k) {
    Scene scene = three_squares();
    scene.instances[1].to_world.setTranslation(V3f(0, 0, k ? -1.0f : 0.0f));
    return scene;
  };
  const DeepAlpha deep = Renderer().render_shutter(scene_at, 2, small_picture()).film.deep;
  // At both moments 3/4 reach the square that moves, and half of them stop there.
  expect_alphas(of_pixel(deep, 15), {{4, 0.25f}, {5, 0.25f}, {6, 1 / 3.0f}}, 0.03);
}

TEST(DeepAlpha, DoesNotGoWithCheckpoints) {
  RenderControl control;
  control.checkpoint = "a.ckpt";
  const Error error =
      film_test::error_of([&] { render(three_squares(), small_picture(), control); });
  EXPECT_EQ(error.kind(), ErrorKind::usage);
  EXPECT_TRUE(film_test::contains(error.what(), "--deep")) << error.what();
}

class DeepFile : public film_test::FilmFile {};

/// Depths and alphas of every pixel of the file, by OpenEXR.
DeepAlpha read_deep(const std::string& path) {
  Imf::DeepScanLineInputFile in(path.c_str());
  EXPECT_TRUE(in.header().hasType() && in.header().type() == Imf::DEEPSCANLINE);
  const Imath::Box2i window = in.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<unsigned> count(pixels);
  std::vector<float*> z(pixels), alpha(pixels);
  const auto stride = static_cast<std::size_t>(width);
  const std::ptrdiff_t before = window.min.x + std::ptrdiff_t{window.min.y} * width;
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(count.data() - before), 4, 4 * stride));
  for (const auto& [channel, to] : {std::pair("Z", &z), {"A", &alpha}})
    buffer.insert(channel, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(to->data() - before),
                                          8, 8 * stride, sizeof(float)));
  in.setFrameBuffer(buffer);
  in.readPixelSampleCounts(window.min.y, window.max.y);
  DeepAlpha deep;
  for (const unsigned n : count) {
    deep.first.push_back(deep.samples.size());
    deep.samples.resize(deep.samples.size() + n);
  }
  deep.first.push_back(deep.samples.size());
  std::vector<float> depths(deep.samples.size()), alphas(deep.samples.size());
  for (std::size_t p = 0; p < pixels; ++p) {
    z[p] = depths.data() + deep.first[p];
    alpha[p] = alphas.data() + deep.first[p];
  }
  in.readPixels(window.min.y, window.max.y);
  for (std::size_t i = 0; i < depths.size(); ++i) deep.samples[i] = {depths[i], alphas[i]};
  return deep;
}

TEST_F(DeepFile, HasWhatTheFilmHasAlsoOfACrop) {
  for (const bool crop : {false, true}) {
    RenderOptions options = small_picture();
    options.spp = 8;
    if (crop) options.crop = PixelRect{5, 2, 12, 6};
    const Film film = render(three_squares(), options).film;
    write_deep_exr(film, path("deep.exr"));
    const DeepAlpha back = read_deep(path("deep.exr"));
    EXPECT_EQ(back.first, film.deep.first);
    ASSERT_EQ(back.samples.size(), film.deep.samples.size());
    EXPECT_EQ(std::memcmp(back.samples.data(), film.deep.samples.data(),
                          back.samples.size() * sizeof(DeepAlpha::Sample)),
              0);
  }
}

TEST_F(DeepFile, OfAnEmptyPictureIsEmptyAndOfAFilmWithoutDepthsAnError) {
  Film film;
  film.width = film.height = 3;
  film.data_window = {0, 0, 2, 2};
  EXPECT_EQ(film_test::error_of([&] { write_deep_exr(film, path("deep.exr")); }).kind(),
            ErrorKind::failed);
  EXPECT_EQ(files_in_folder(), 0u);
  film.deep = DeepSums(9).alpha(std::vector<std::uint32_t>(9, 4));
  write_deep_exr(film, path("deep.exr"));
  EXPECT_TRUE(read_deep(path("deep.exr")).samples.empty());
}

class DeepProgram : public program_test::ProgramRun {};

const char* const kTree =
    "render 'scene:tree?leaves=2000' --width 64 --height 36 --spp 8 -q --opacity leaf=0.3 "
    "--passes ao ";

TEST_F(DeepProgram, TheNumberOfThreadsChangesNothing) {
  const std::string render = kTree;
  ASSERT_EQ(
      dapple(render + "-o a.exr --deep one.exr", "POCL_MAX_PTHREAD_COUNT=1 taskset -c 0").code, 0);
  ASSERT_EQ(dapple(render + "-o a.exr --deep two.exr", "POCL_MAX_PTHREAD_COUNT=2").code, 0);
  EXPECT_EQ(film_test::bytes_of(path("one.exr")), film_test::bytes_of(path("two.exr")));
  EXPECT_FALSE(read_deep(path("one.exr")).samples.empty());
}

TEST_F(DeepProgram, PathsAreCheckedBeforeRendering) {
  const std::string render = kTree;
  expect_failure(dapple(render + "-o a.exr --deep a.exr"), 2, "--deep a.exr: is the same file");
  expect_failure(dapple(render + "-o a.exr --deep none/a.exr"), 2, "--deep");
  expect_failure(dapple(render + "-o a.#.exr --frames 0-1 --deep a.exr"), 2, "--deep a.exr");
  expect_failure(dapple(render + "-o a.exr --deep b.exr --checkpoint a.ckpt"), 2, "--deep");
  EXPECT_EQ(files_in_folder(), 0u);
}

}  // namespace
}  // namespace dapple
