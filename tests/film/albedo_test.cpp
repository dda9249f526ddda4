// The layer albedo against direct look-ups in textures and colours of corners.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "dapple/render.hpp"
#include "device/upload/color_upload.hpp"
#include "support/files/hair_builder.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

using test::scene_of;

double linear_of(int code) {
  const double value = code / 255.0;
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

/// A square from (-1, -1) to (1, 1) that faces +Z; texture coordinates from (0, 1) to (1, 0).
Scene square() {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  Scene scene = scene_of(std::move(mesh));
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 1;
  camera.to_world.setTranslation(V3f(0, 0, 5));
  scene.cameras = {camera};
  return scene;
}

ColorTexture random_texture(std::uint32_t side) {
  std::mt19937 bits(1);
  ColorTexture texture;
  texture.width = texture.height = side;
  for (std::uint32_t i = 0; i < 3 * side * side; ++i)
    texture.rgb.push_back(static_cast<std::uint8_t>(bits() >> 24));
  return texture;
}

RenderOptions picture(int side, int spp) {
  RenderOptions options;
  options.width = options.height = side;
  options.spp = spp;
  options.camera_splitting = 1;
  options.light = false;
  return options;
}

float at(const Film& film, const std::string& channel, std::size_t pixel) {
  return film.find(channel)->pixels[pixel];
}

constexpr std::array<const char*, 3> kAlbedo{"albedo.R", "albedo.G", "albedo.B"};

/// Bilinear in linear light, texture coordinates clamped or repeated.
double looked_up(const ColorTexture& texture, double u, double v, int channel) {
  const int side = static_cast<int>(texture.width);
  const double x = u * side - 0.5, y = v * side - 0.5;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const auto texel = [&](int i, int j) {
    const auto wrapped = [&](int k) { return (k % side + side) % side; };
    return linear_of(
        texture.rgb[static_cast<std::size_t>(3 * (wrapped(j) * side + wrapped(i)) + channel)]);
  };
  const double a = x - column, b = y - row;
  return (texel(column, row) * (1 - a) + texel(column + 1, row) * a) * (1 - b) +
         (texel(column, row + 1) * (1 - a) + texel(column + 1, row + 1) * a) * b;
}

TEST(Albedo, AConstantColourIsItself) {
  Scene scene = square();
  scene.materials[0].color = V3f(0.2f, 0.5f, 0.8f);
  const Film film = render(scene, picture(16, 4)).film;
  for (std::size_t p = 0; p < 256; ++p) {
    EXPECT_NEAR(at(film, "albedo.R", p), 0.2f, 1e-6);
    EXPECT_NEAR(at(film, "albedo.G", p), 0.5f, 1e-6);
    EXPECT_NEAR(at(film, "albedo.B", p), 0.8f, 1e-6);
  }
}

TEST(Albedo, TrianglesOfOneBlockHaveTheirOwnMaterialsAndColours) {
  Scene scene = square();
  scene.materials.resize(2);
  scene.materials[0].color = V3f(0.25f, 0.5f, 0.125f);
  scene.materials[1].color = V3f(1, 0.0625f, 0.25f);
  scene.meshes[0].materials = {0, 1};
  const auto check = [&](const V3f& below, const V3f& above) {
    const Film film = render(scene, picture(16, 1)).film;
    for (std::size_t p = 0; p < 256; ++p) {
      const float side = at(film, "P.Y", p) - at(film, "P.X", p);
      if (std::fabs(side) < 1e-3f) continue;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(at(film, kAlbedo[c], p), (side < 0 ? below : above)[static_cast<int>(c)],
                    1e-3f);
    }
  };
  check(scene.materials[0].color, scene.materials[1].color);
  scene.meshes[0].colors.assign(4, V3f(0.5f, 1, 1));  // then both have words of their own
  check({0.125f, 0.5f, 0.125f}, {0.5f, 0.0625f, 0.25f});
}

TEST(Albedo, ABlockOfOneMaterialTakesOneWord) {
  std::mt19937 bits(3);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    mesh.positions.emplace_back(static_cast<float>(bits() % 1000),
                                static_cast<float>(bits() % 1000),
                                static_cast<float>(bits() % 1000));
    mesh.indices.push_back(i);
  }
  const Scene scene = scene_of(std::move(mesh));
  const SceneBvh bvh = build_bvh(scene);
  EXPECT_EQ(pack_colors(scene, bvh).words.size(), bvh.blocks.size() + 2 * scene.materials.size());
}

// With one sample per pixel the layer P says where the texture was looked up. Texels are stored in
// 10 bits or more of their square roots: to 1e-3 at white, a quarter of half a step of 8-bit sRGB.
TEST(Albedo, AMagnifiedTextureIsADirectLookUp) {
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::blend}) {
    Scene scene = square();
    scene.color_textures = {random_texture(8)};
    scene.materials[0].color_texture = 0;
    scene.materials[0].color = V3f(1, 0.5f, 1);
    // A blended texture of alphas of 1: the triangle then has texture coordinates of its own.
    scene.materials[0].alpha_mode = mode;
    if (mode == AlphaMode::blend) {
      scene.textures.resize(1);
      scene.textures[0].width = scene.textures[0].height = 8;
      scene.textures[0].alpha.assign(64, 255);
      scene.materials[0].alpha_texture = 0;
    }
    const Film film = render(scene, picture(64, 1)).film;
    for (std::size_t p = 0; p < 64 * 64; ++p) {
      ASSERT_EQ(at(film, "A", p), 1.0f);
      const double u = 0.5 + 0.5 * at(film, "P.X", p), v = 0.5 - 0.5 * at(film, "P.Y", p);
      for (int channel = 0; channel < 3; ++channel) {
        const double expected =
            looked_up(scene.color_textures[0], u, v, channel) * (channel == 1 ? 0.5 : 1);
        EXPECT_NEAR(at(film, kAlbedo[static_cast<std::size_t>(channel)], p), expected, 1e-3)
            << "pixel " << p;
      }
    }
  }
}

// Of coordinates from 1 to 2 a clamped texture shows its last texels, whatever the alphas repeat.
TEST(Albedo, AColourTextureWrapsByItsOwnModes) {
  Scene scene = square();
  for (V2f& uv : scene.meshes[0].uvs) uv.x += 1;
  scene.color_textures.resize(1);
  scene.color_textures[0].width = 2;
  scene.color_textures[0].height = 1;
  scene.color_textures[0].rgb = {255, 0, 0, 0, 255, 0};
  scene.color_textures[0].wrap_s = Wrap::clamp;
  scene.textures.resize(1);
  scene.textures[0].width = 2;
  scene.textures[0].height = 1;
  scene.textures[0].alpha = {200, 250};
  scene.materials[0].color_texture = scene.materials[0].alpha_texture = 0;
  scene.materials[0].alpha_mode = AlphaMode::blend;
  const Film film = render(scene, picture(16, 1)).film;
  for (std::size_t p = 0; p < 256; ++p) {
    if (at(film, "A", p) == 0) continue;  // the ray slipped through
    EXPECT_NEAR(at(film, "albedo.R", p), 0, 1e-3) << p;
    EXPECT_NEAR(at(film, "albedo.G", p), 1, 1e-3) << p;
  }
}

TEST(Albedo, APixelOfManyTexelsIsTheirMean) {
  Scene scene = square();
  ColorTexture texture = random_texture(512);
  double mean = 0;
  for (std::size_t i = 0; i < texture.rgb.size(); i += 3) mean += linear_of(texture.rgb[i]);
  mean /= 512.0 * 512;
  scene.color_textures = {texture};
  scene.materials[0].color_texture = 0;
  const Film film = render(scene, picture(16, 16)).film;
  double sum = 0, squares = 0;
  for (std::size_t p = 0; p < 256; ++p) {
    sum += at(film, "albedo.R", p);
    squares += std::pow(at(film, "albedo.R", p) - mean, 2);
  }
  EXPECT_NEAR(sum / 256, mean, 0.003);
  // 1,024 texels of a deviation of 0.3 would have 0.01; sixteen single texels 0.08.
  EXPECT_LE(std::sqrt(squares / 256), 0.03);
}

// Between a leaf and what is cut out around it half of a look-up is of texels that are not seen.
TEST(Albedo, WhatIsCutOutDoesNotColourTheRim) {
  for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend}) {
    Scene scene = square();
    ColorTexture color;
    Texture alpha;
    color.width = color.height = alpha.width = alpha.height = 16;
    for (std::size_t i = 0; i < 256; ++i) {
      const bool seen = (i % 16 / 4 + i / 64) % 2 == 0;
      color.rgb.insert(color.rgb.end(), 3, 255);
      if (seen) color.rgb[3 * i + 1] = color.rgb[3 * i + 2] = 0;
      alpha.alpha.push_back(seen ? 255 : 0);
    }
    color.alpha = alpha.alpha;
    scene.color_textures = {color};
    scene.textures = {alpha};
    Material& material = scene.materials[0];
    material.color_texture = material.alpha_texture = 0;
    material.alpha_mode = mode;
    for (const int size : {4, 16, 64}) {
      const Film film = render(scene, picture(size, 4)).film;
      const std::vector<float>& seen = film.find("A")->pixels;
      EXPECT_GT(std::accumulate(seen.begin(), seen.end(), 0.0), 0.1 * size * size);
      for (std::size_t p = 0; p < seen.size(); ++p) {
        if (seen[p] == 0) continue;
        EXPECT_NEAR(at(film, "albedo.R", p), 1, 2e-3) << size;
        EXPECT_NEAR(at(film, "albedo.G", p), 0, 2e-3) << size;
      }
    }
  }
}

TEST(Albedo, ColoursOfCornersAreInterpolated) {
  Scene scene = square();
  scene.meshes[0].colors = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  scene.materials[0].color = V3f(1, 1, 0.5f);
  const Film film = render(scene, picture(32, 1)).film;
  for (std::size_t p = 0; p < 32 * 32; ++p) {
    EXPECT_NEAR(at(film, "albedo.R", p), 0.5f + 0.5f * at(film, "P.X", p), 1e-3);
    EXPECT_NEAR(at(film, "albedo.G", p), 0.5f + 0.5f * at(film, "P.Y", p), 1e-3);
    EXPECT_NEAR(at(film, "albedo.B", p), 0.5f, 1e-6);
  }
}

TEST(Albedo, StrandsHaveTheColoursOfTheirEnds) {
  Mesh strand;
  strand.positions = {{-1, 0, 0}, {1, 0, 0}};
  strand.radii = {0.5f, 0.5f};
  strand.colors = {{0.25f, 0, 1}, {0.25f, 1, 1}};
  strand.indices = {0, 1};
  strand.materials = {0};
  Scene scene = square();
  Scene before_a_square = scene;  // of triangles, whose words come first
  scene.meshes = {strand};
  for (V3f& p : before_a_square.meshes[0].positions) p.z = -2;
  before_a_square.meshes[0].materials = {1, 1};
  before_a_square.materials.resize(2);
  before_a_square.materials[1].color = V3f(0.125f, 1, 0.0625f);
  before_a_square.meshes.push_back(strand);
  before_a_square.instances.resize(2);
  before_a_square.instances[1].mesh = 1;
  const std::size_t middle = 16 * 32 + 16, edge = 2 * 32 + 16;
  for (const Scene& shown : {scene, before_a_square}) {
    const Film film = render(shown, picture(32, 4)).film;
    ASSERT_EQ(at(film, "A", middle), 1.0f);
    EXPECT_NEAR(at(film, "albedo.R", middle), 0.25f, 1e-3);
    EXPECT_NEAR(at(film, "albedo.G", middle), 0.5f, 1e-3);
    EXPECT_NEAR(at(film, "albedo.B", middle), 1, 1e-6);
    if (shown.meshes.size() > 1) {
      EXPECT_NEAR(at(film, "albedo.R", edge), 0.125f, 1e-3);
    }
  }
}

/// A file of two strands of two segments each, from x = -1 to 1, at y = 0.5 and y = -0.5.
test::HairBuilder two_level_strands() {
  test::HairBuilder builder;
  builder.strands = 2;
  builder.default_segments = 2;
  builder.default_thickness = 0.5f;
  builder.points = {-1, 0.5f, 0, 0, 0.5f, 0, 1, 0.5f, 0, -1, -0.5f, 0, 0, -0.5f, 0, 1, -0.5f, 0};
  return builder;
}

/// The albedo in the middle of each segment, in the file's order.
std::vector<V3f> albedo_of_level_strands(const test::HairBuilder& builder) {
  const test::TempFolder folder;
  Scene scene = load_scene(folder.write("level.hair", builder.bytes()));
  scene.cameras = square().cameras;
  const Film film = render(scene, picture(32, 4)).film;
  std::vector<V3f> colors;
  for (const std::size_t pixel : {8 * 32 + 8, 8 * 32 + 24, 24 * 32 + 8, 24 * 32 + 24}) {
    EXPECT_EQ(at(film, "A", pixel), 1.0f);
    colors.emplace_back(at(film, "albedo.R", pixel), at(film, "albedo.G", pixel),
                        at(film, "albedo.B", pixel));
  }
  return colors;
}

// A segment has the mean of its ends, stored as colours of textures are: to 1e-3.
TEST(Albedo, StrandsOfAHairFileHaveItsColours) {
  test::HairBuilder builder = two_level_strands();
  builder.colors = {1,    0,     0, 0, 1,    0,     0, 0, 1,  //
                    0.5f, 0.25f, 1, 0, 0.5f, 0.25f, 1, 1, 0.75f};
  const std::vector<V3f> expected = {
      {0.5f, 0.5f, 0}, {0, 0.5f, 0.5f}, {0.25f, 0.375f, 0.625f}, {0.5f, 0.75f, 0.5f}};
  const std::vector<V3f> shown = albedo_of_level_strands(builder);
  for (std::size_t i = 0; i < 4; ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(shown[i][c], expected[i][c], 1e-3) << i;
  builder.colors.clear();
  builder.default_color = {0.75f, 0.5f, 0.25f};
  for (const V3f& color : albedo_of_level_strands(builder))
    EXPECT_LE((color - V3f(0.75f, 0.5f, 0.25f)).length(), 1e-6f) << "the header's";
}

TEST(Albedo, InstancesHaveTheColoursOfTheirMesh) {
  Scene scene = square();
  scene.color_textures = {random_texture(64)};
  scene.materials[0].color_texture = 0;
  Scene placed = scene;
  placed.instances.resize(400);  // too many copies of a tiny mesh are not merged
  placed.instances[0].to_world.setScale(0.5f);
  for (std::size_t i = 1; i < placed.instances.size(); ++i)
    placed.instances[i].to_world.setTranslation(V3f(100.0f + static_cast<float>(i), 0, 0));
  for (V3f& p : scene.meshes[0].positions) p *= 0.5f;
  const Film a = render(scene, picture(32, 16)).film, b = render(placed, picture(32, 16)).film;
  for (std::size_t p = 0; p < 32 * 32; ++p)
    EXPECT_NEAR(at(a, "albedo.R", p), at(b, "albedo.R", p), 1e-4) << "pixel " << p;
}

TEST(Albedo, SparseNodesThatAreMediaHaveColoursOfTheirTriangles) {
  RenderOptions options = picture(64, 8);
  options.target_rmse = 0.02f;
  const Film film = render(load_scene("scene:cloud?leaves=20000&opacity=0.3"), options).film;
  int seen = 0;
  for (std::size_t p = 0; p < 64 * 64; ++p) {
    if (at(film, "A", p) == 0) continue;
    ++seen;
    EXPECT_NEAR(at(film, "albedo.R", p), 0.11f, 1e-5);
    EXPECT_NEAR(at(film, "albedo.G", p), 0.22f, 1e-5);
  }
  EXPECT_GT(seen, 500);
}

TEST(Albedo, ANewColourOfAKeptSceneIsSeen) {
  Scene scene = square();
  Renderer renderer;
  renderer.render(scene, picture(8, 4));
  scene.materials[0].color = V3f(0.125f);
  EXPECT_NEAR(at(renderer.render(scene, picture(8, 4)).film, "albedo.G", 20), 0.125f, 1e-6);
}

TEST(Albedo, LeavesAllOtherLayersAsTheyAreAndIsGoneWhenOff) {
  RenderOptions options;
  options.width = options.height = 32;
  const Scene scene = load_scene("scene:tree?leaves=500");
  const Film with = render(scene, options).film;
  options.albedo = false;
  const Film without = render(scene, options).film;
  EXPECT_EQ(without.find("albedo.R"), nullptr);
  for (const Plane& plane : without.planes) {
    if (plane.channel.size() == 1 && plane.channel != "A" && plane.channel != "Z") continue;
    EXPECT_EQ(plane.pixels, with.find(plane.channel)->pixels) << plane.channel;
  }
}

}  // namespace
}  // namespace dapple
