// Textured triangles packed into 24 bytes: the rounding of coordinates and alphas, finite values
// for every input, the same values on host and device, and the index of the material.
#include "bvh/storage/textured_triangle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "dapple/bvh.hpp"
#include "dapple/error.hpp"
#include "device/upload/scene_upload.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/test_kernel.hpp"

namespace dapple {
namespace {

constexpr Wrap kWraps[] = {Wrap::repeat, Wrap::clamp, Wrap::mirror};

TexturedCorners corners_at(const V2f& a, const V2f& b, const V2f& c) {
  TexturedCorners corners;
  corners.uv = {a, b, c};
  corners.has_texture = true;
  return corners;
}

TexturedCorners packed(const TexturedCorners& corners, Wrap wrap_s, Wrap wrap_t) {
  return unpack_textured(pack_textured(corners, wrap_s, wrap_t));
}

/// Number of whole tiles that packing subtracts from coordinates whose minimum is `min`.
double tiles(double min, Wrap wrap) {
  if (wrap == Wrap::clamp) return 0;
  return wrap == Wrap::repeat ? std::floor(min) : 2 * std::floor(min / 2);
}

/// Maximum rounding error of coordinates that are in [min, max] after whole tiles are
/// subtracted. Their range is the smallest power of two, 1 or more, that they are below after
/// rounding. The error is half of 2^-21 of this range, or half of 2^-20 if a coordinate is
/// negative.
double allowed(double min, double max) {
  double size = 1;
  while (max >= size * (1 - 0x1p-21) || -min > size) size *= 2;
  return size * (min <= -0x1p-22 ? 0x1p-21 : 0x1p-22);
}

void expect_within_half_a_step(const TexturedCorners& given, Wrap wrap_s, Wrap wrap_t) {
  const TexturedCorners held = packed(given, wrap_s, wrap_t);
  const Wrap wraps[2] = {wrap_s, wrap_t};
  double folded[3][2], min = 1e300, max = -1e300;
  for (int axis = 0; axis < 2; ++axis) {
    const double first = std::min({given.uv[0][axis], given.uv[1][axis], given.uv[2][axis]});
    for (int corner = 0; corner < 3; ++corner) {
      folded[corner][axis] = given.uv[corner][axis] - tiles(first, wraps[axis]);
      min = std::min(min, folded[corner][axis]);
      max = std::max(max, folded[corner][axis]);
    }
  }
  for (int axis = 0; axis < 2; ++axis) {
    for (int corner = 0; corner < 3; ++corner) {
      EXPECT_NEAR(held.uv[corner][axis], folded[corner][axis], allowed(min, max))
          << given.uv[0] << given.uv[1] << given.uv[2];
    }
  }
}

TEST(TexturedTriangle, CoordinatesAreWithinHalfAStepButForWholeTiles) {
  std::mt19937 random(1);
  for (const float reach : {1e-30f, 1e-6f, 0.01f, 1.0f, 3.0f, 50.0f, 4000.0f, 1e6f, 1e9f, 1e17f}) {
    std::uniform_real_distribution<float> at(-reach, reach), size(-1, 1);
    for (int i = 0; i < 200; ++i) {
      const V2f corner(at(random), at(random)), across(size(random), size(random));
      for (const Wrap s : kWraps) {
        for (const Wrap t : kWraps) {
          expect_within_half_a_step(
              corners_at(corner, {at(random), at(random)}, {at(random), at(random)}), s, t);
          expect_within_half_a_step(corners_at(corner, corner + across, corner - across), s, t);
          expect_within_half_a_step(corners_at(corner, corner, corner), s, t);
        }
      }
    }
  }
}

TEST(TexturedTriangle, TexelsOfPowersOfTwoAreExactAndNeighboursAgree) {
  const auto exact = [](const V2f& a, const V2f& b, const V2f& c, Wrap wrap) {
    EXPECT_EQ(packed(corners_at(a, b, c), wrap, wrap).uv, (std::array{a, b, c}));
  };
  for (const Wrap wrap : kWraps) {
    exact({0, 0}, {1, 0}, {1, 1}, wrap);
    exact({0, 0}, {0.25f, 1}, {16, 0.5f}, wrap);
    exact({3.0f / 4096, 5.0f / 8192}, {2047.0f / 2048, 0}, {0, 4095.0f / 4096}, wrap);
  }
  exact({-1, 0}, {1, 2}, {-0.25f, 0.5f}, Wrap::clamp);
  const V2f shared(0.123456f, 0.654321f);
  EXPECT_EQ(
      packed(corners_at({0, 0}, shared, {0.9f, 0.1f}), Wrap::repeat, Wrap::clamp).uv[1],
      packed(corners_at(shared, {0.3f, 0.7f}, {0.2f, 0.2f}), Wrap::repeat, Wrap::clamp).uv[0]);
}

TEST(TexturedTriangle, EveryCoordinateAndAlphaPacksToAFiniteValue) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float values[] = {0,     1,          -1e30f,    1e30f,
                          3e38f, -kInfinity, kInfinity, std::nanf(""),
                          0.5f,  1e-45f,     -1e-45f,   std::nextafter(1.0f, 0.0f)};
  for (const Wrap wrap : kWraps) {
    for (const float a : values) {
      for (const float b : values) {
        TexturedCorners given = corners_at({a, b}, {b, 0.5f}, {0.25f, a});
        given.alpha = {a, b, 0.5f};
        const TexturedCorners held = packed(given, wrap, Wrap::repeat);
        for (int corner = 0; corner < 3; ++corner) {
          EXPECT_TRUE(std::isfinite(held.uv[corner].x) && std::isfinite(held.uv[corner].y))
              << a << " " << b;
          EXPECT_TRUE(held.alpha[corner] >= 0 && held.alpha[corner] <= 1) << a << " " << b;
        }
        // Large coordinates must not change the other bits of the record.
        EXPECT_EQ(held.alpha[2], 0.5f);
        EXPECT_TRUE(held.has_texture);
        EXPECT_EQ(held.material, 0u);
      }
    }
  }
}

TEST(TexturedTriangle, AlphasHaveTwelveBitsAndThoseOf8BitColoursAreExact) {
  const auto held = [](float alpha) {
    TexturedCorners corners;
    corners.alpha = {0, alpha, 1};
    const TexturedCorners back = packed(corners, Wrap::repeat, Wrap::repeat);
    EXPECT_EQ(back.alpha[0], 0.0f);
    EXPECT_EQ(back.alpha[2], 1.0f);
    return back.alpha[1];
  };
  for (int i = 0; i <= 100000; ++i) {
    const float alpha = static_cast<float>(i) / 100000;
    EXPECT_NEAR(held(alpha), alpha, 0.5 / 4080 + 1e-7);
  }
  for (int i = 0; i <= 255; ++i) {
    const float colour = static_cast<float>(i) / 255;
    EXPECT_NEAR(held(colour), colour, 6e-8) << i;  // one rounding of a float below 1
  }
}

TEST(TexturedTriangle, SizesOfTexelsAreStoredAsPowersOfTwo) {
  const auto held = [](float size) {
    TexturedCorners corners = corners_at({0, 0}, {1, 0}, {0, 1});
    corners.material = DAPPLE_MAX_TEXTURED_MATERIALS - 1;
    corners.texel_size = size;
    const TexturedCorners back = packed(corners, Wrap::repeat, Wrap::repeat);
    EXPECT_EQ(back.material, DAPPLE_MAX_TEXTURED_MATERIALS - 1);
    return back.texel_size;
  };
  for (int exponent = -24; exponent <= 6; ++exponent) {
    const float size = std::ldexp(1.0f, exponent);
    EXPECT_EQ(held(size), size);
    EXPECT_EQ(held(1.4f * size), size);
    EXPECT_EQ(held(0.72f * size), size);
  }
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float unknown : {0.0f, -1.0f, 1e-9f, 100.0f, infinity, std::nanf("")})
    EXPECT_EQ(held(unknown), 0) << unknown;
}

TEST(TexturedTriangle, MaterialsAndTextureFlagsAreUnpackedUnchanged) {
  TexturedCorners corners = corners_at({0.99f, 0.01f}, {0.5f, 0.9f}, {-7, 1});
  corners.alpha = {0.1f, 0.9f, 0.5f};
  for (const std::uint32_t material :
       {0u, 1u, 1023u, 1024u, 7777u, DAPPLE_MAX_TEXTURED_MATERIALS - 1u}) {
    for (const bool has_texture : {false, true}) {
      corners.material = material;
      corners.has_texture = has_texture;
      const TexturedCorners back = packed(corners, Wrap::clamp, Wrap::mirror);
      EXPECT_EQ(back.material, material);
      EXPECT_EQ(back.has_texture, has_texture);
    }
  }
}

std::vector<TexturedCorners> many_corners() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(0, 1);
  std::vector<TexturedCorners> many;
  for (const float reach : {0.5f, 1.0f, 30.0f, 1e6f, 1e30f}) {
    std::uniform_real_distribution<float> at(-reach, reach);
    for (int i = 0; i < 200; ++i) {
      TexturedCorners corners =
          corners_at({at(random), at(random)}, {at(random), at(random)}, {at(random), at(random)});
      corners.alpha = {share(random), share(random), share(random)};
      corners.material = random() % DAPPLE_MAX_TEXTURED_MATERIALS;
      corners.has_texture = i % 5 != 0;
      many.push_back(corners);
    }
  }
  return many;
}

TEST(TexturedTriangle, TheDeviceUnpacksTheSameNumbersAsTheHost) {
  using namespace kernel_test;
  const std::vector<TexturedCorners> many = many_corners();
  std::vector<TexturedTriangle> triangles;
  for (std::size_t i = 0; i < many.size(); ++i)
    triangles.push_back(pack_textured(many[i], kWraps[i % 3], kWraps[i / 3 % 3]));
  const std::size_t count = triangles.size();
  const Buffer corners = device().allocate(count * 9 * sizeof(float)),
               materials = device().allocate(count * sizeof(uint)),
               textures = device().allocate(count * sizeof(uint));
  run("lookup", "unpack_corners", count,
      {upload(triangles), corners, materials, textures, static_cast<uint>(count)});
  const auto unpacked = download<float>(corners, count * 9);
  const auto named = download<uint>(materials, count), textured = download<uint>(textures, count);
  for (std::size_t i = 0; i < count; ++i) {
    const TexturedCorners host = unpack_textured(triangles[i]);
    EXPECT_EQ(named[i], many[i].material);
    EXPECT_EQ(textured[i] != 0, many[i].has_texture);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const float* at = &unpacked[9 * i + 3 * corner];
      // A value is a whole number of steps, below 2^24, times a power of two. So nothing rounds.
      EXPECT_EQ(V2f(at[0], at[1]), host.uv[corner]);
      EXPECT_EQ(at[2], host.alpha[corner]);
    }
  }
}

/// A triangle in the plane z = 0. The scene has `materials` blended materials, which share one
/// texture; the triangle has the last of them.
Scene scene_of_materials(std::size_t materials) {
  Scene scene;
  scene.source = "many";
  scene.textures.push_back({"leaf", 4, 4, std::vector<std::uint8_t>(16, 128)});
  Material material;
  material.name = "leaf";
  material.alpha_mode = AlphaMode::blend;
  material.alpha_texture = 0;
  scene.materials.assign(materials, material);
  for (std::size_t i = 0; i < std::min<std::size_t>(materials, 100); ++i)
    scene.materials[i].alpha = 1.0f / static_cast<float>(i + 1);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.indices = {0, 1, 2};
  mesh.materials = {static_cast<std::uint32_t>(materials - 1)};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({0, M44f(), -1});
  return scene;
}

TEST(TexturedTriangle, AMaterialTooManyIsRefusedByName) {
  const Scene max_materials = scene_of_materials(DAPPLE_MAX_TEXTURED_MATERIALS);
  EXPECT_EQ(unpack_textured(build_bvh(max_materials).textured[0]).material,
            DAPPLE_MAX_TEXTURED_MATERIALS - 1u);
  try {
    build_bvh(scene_of_materials(DAPPLE_MAX_TEXTURED_MATERIALS + 1));
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failed);
    EXPECT_NE(std::string(error.what()).find("material 32768 (leaf)"), std::string::npos)
        << error.what();
  }
}

TEST(TexturedTriangle, MaterialsShareTheTexelsOfTheirTexture) {
  const scene_test::SceneOnDevice scene(scene_of_materials(3));
  const DeviceBuffers& buffers = *scene.uploaded.buffers;
  // The mip levels begin at multiples of 16 texels: 4x4 at 0, 2x2 at 16, one texel at 32.
  EXPECT_EQ(buffers.texel_data.size(), 33u);
  ASSERT_EQ(buffers.material_records.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(buffers.material_records[i].texture.offset, 0u);
    EXPECT_EQ(buffers.material_records[i].texture.width, 4u);
    EXPECT_EQ(buffers.material_records[i].mips, 2u);
    EXPECT_EQ(buffers.material_records[i].mip_offset[0], 1u);
    EXPECT_EQ(buffers.material_records[i].mip_offset[1], 2u);
    EXPECT_EQ(buffers.material_records[i].alpha, 1.0f / static_cast<float>(i + 1));
  }
  const auto through =
      scene.trace({scene_test::make_ray({0.2f, 0.2f, 1}, {0, 0, -1})}, Estimator::exact);
  EXPECT_NEAR(through[0].transmittance, 1 - 128.0 / 255 / 3, 1e-5);
}

}  // namespace
}  // namespace dapple
