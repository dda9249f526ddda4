// Coverage maps: drawing triangles and compositing the maps of children keep areas. Opacity
// mip levels: means of a texture's opacity over mip footprints, with its cutoff and wrap modes.
#include "bvh/opacity/coverage_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bvh/build/object_bvh.hpp"
#include "bvh/opacity/texture_integrals.hpp"
#include "support/scenes/uniform_map.hpp"

namespace dapple {
namespace {

class Numbers {
 public:
  explicit Numbers(unsigned seed) : random_(seed) {}
  float between(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random_);
  }
  V3f vector(float low, float high) {
    V3f v;
    for (int a = 0; a < 3; ++a) v[a] = between(low, high);
    return v;
  }

 private:
  std::mt19937 random_;
};

const auto kNotVarying = [](const CoveringTriangle&, float, float, float) -> float {
  ADD_FAILURE() << "a uniform triangle was looked up";
  return 0;
};

CoveringTriangle triangle_of(const V3f& a, const V3f& b, const V3f& c, float opacity) {
  return {a, b - a, c - a, opacity};
}

/// Share of the box's face across `axis` that the triangle covers, in double precision.
double projected_share(const CoveringTriangle& t, const Box3f& box, int axis) {
  const int u = column_axis(axis), v = row_axis(axis);
  const double cross =
      static_cast<double>(t.edge1[u]) * t.edge2[v] - static_cast<double>(t.edge1[v]) * t.edge2[u];
  const double width = static_cast<double>(box.max[u]) - box.min[u];
  const double height = static_cast<double>(box.max[v]) - box.min[v];
  return 0.5 * std::fabs(cross) / (width * height);
}

void expect_area_kept(const CoveringTriangle& triangle, const Box3f& box) {
  CoverageMap map;
  cover(map, box, std::array{triangle}, kNotVarying);
  for (int axis = 0; axis < 3; ++axis) {
    // 1e-5 covers the rounding of a sum over 256 cells of numbers up to 1.
    EXPECT_NEAR(map.mean_opacity(axis), triangle.opacity * projected_share(triangle, box, axis),
                1e-5)
        << "axis " << axis << ", triangle " << triangle.vertex << " " << triangle.edge1 << " "
        << triangle.edge2;
    for (const float t : map.transmittance[axis]) {
      ASSERT_TRUE(t >= 0 && t <= 1) << t;
    }
  }
}

const Box3f kBox(V3f(-1, 2, 0), V3f(1, 5, 0.5f));

V3f in_box(const V3f& unit) {
  V3f p;
  for (int a = 0; a < 3; ++a) p[a] = kBox.min[a] + unit[a] * (kBox.max[a] - kBox.min[a]);
  return p;
}

TEST(CoverageMap, TrianglesMeansAreTheirProjectedAreas) {
  Numbers numbers(1);
  double error = 0;
  const int count = 2000;
  for (int i = 0; i < count; ++i) {
    const V3f a = numbers.vector(0, 1), b = numbers.vector(0, 1), c = numbers.vector(0, 1);
    const CoveringTriangle triangle = triangle_of(in_box(a), in_box(b), in_box(c), 0.8f);
    CoverageMap map;
    cover(map, kBox, std::array{triangle}, kNotVarying);
    for (int axis = 0; axis < 3; ++axis) {
      const double off = map.mean_opacity(axis) - 0.8 * projected_share(triangle, kBox, axis);
      // A cell at a very sharp corner would be more than full. The error is at most half a cell.
      ASSERT_NEAR(off, 0, 0.5 / kMapCells) << "triangle " << i;
      error += off / (3 * count);
    }
  }
  // Such cells are rare: the mean error of all triangles is near 0.
  EXPECT_NEAR(error, 0, 1e-5);
}

TEST(CoverageMap, ASliversMeanIsItsProjectedArea) {
  Numbers numbers(2);
  for (int i = 0; i < 2000; ++i) {
    const V3f a = numbers.vector(0.01f, 0.99f), b = numbers.vector(0.01f, 0.99f);
    const V3f c = a + (b - a) * numbers.between(0, 1) + numbers.vector(-0.005f, 0.005f);
    expect_area_kept(triangle_of(in_box(a), in_box(b), in_box(c), 1), kBox);
    if (::testing::Test::HasFailure()) FAIL() << "sliver " << i;
  }
}

TEST(CoverageMap, ATriangleSmallerThanACellKeepsItsArea) {
  Numbers numbers(3);
  for (int i = 0; i < 2000; ++i) {
    const float size = std::pow(10.0f, numbers.between(-4, -1.2f));
    const V3f a = numbers.vector(0.1f, 0.9f), b = a + numbers.vector(-size, size),
              c = a + numbers.vector(-size, size);
    expect_area_kept(triangle_of(in_box(a), in_box(b), in_box(c), 0.9f), kBox);
    if (::testing::Test::HasFailure()) FAIL() << "triangle " << i;
  }
}

TEST(CoverageMap, TheTwoTrianglesOfAFaceFillIt) {
  const V3f a = in_box({0, 0, 0.5f}), b = in_box({1, 0, 0.5f}), c = in_box({1, 1, 0.5f}),
            d = in_box({0, 1, 0.5f});
  CoverageMap map;
  cover(map, kBox, std::array{triangle_of(a, b, c, 1), triangle_of(a, c, d, 1)}, kNotVarying);
  EXPECT_NEAR(map.mean_opacity(2), 1, 1e-5f);
  EXPECT_NEAR(map.mean_opacity(0), 0, 1e-6f);
  EXPECT_NEAR(map.mean_opacity(1), 0, 1e-6f);
}

/// A map with random cells.
CoverageMap random_map(unsigned seed) {
  Numbers numbers(seed);
  CoverageMap map;
  for (auto& axis : map.transmittance) {
    for (float& cell : axis) cell = numbers.between(0, 1);
  }
  return map;
}

TEST(CoverageMap, CompositingKeepsAChildsMeanByArea) {
  Numbers numbers(4);
  for (int i = 0; i < 500; ++i) {
    const V3f p = numbers.vector(0, 1), q = numbers.vector(0, 1);
    Box3f child(in_box(p));
    child.extendBy(in_box(q));
    const CoverageMap inside = random_map(static_cast<unsigned>(i));
    NodeCoverage node(kBox);
    node.add(inside, child);
    const CoverageMap& map = node.map();
    for (int axis = 0; axis < 3; ++axis) {
      const float share = face_area(child, axis) / face_area(kBox, axis);
      EXPECT_NEAR(map.mean_opacity(axis), share * inside.mean_opacity(axis), 1e-5f);
    }
    if (::testing::Test::HasFailure()) FAIL() << "child " << i;
  }
}

TEST(CoverageMap, AChildAsLargeAsItsParentIsTakenOverUnchanged) {
  const CoverageMap inside = random_map(5);
  NodeCoverage node(kBox);
  node.add(inside, kBox);
  const CoverageMap& map = node.map();
  for (int axis = 0; axis < 3; ++axis) {
    for (int cell = 0; cell < kMapCells; ++cell) {
      // The cell borders of both maps agree to 16 roundings of a number up to 16.
      EXPECT_NEAR(map.transmittance[axis][cell], inside.transmittance[axis][cell], 2e-5f);
    }
  }
}

// Boxes anywhere in the parent's, some of them flat or at its border.
TEST(CoverageMap, AUniformChildCountsAsItsMap) {
  Numbers numbers(3);
  for (int round = 0; round < 200; ++round) {
    NodeCoverage by_box(kBox), by_map(kBox);
    for (int child = 0; child < 4; ++child) {
      Box3f box;
      for (int corner = 0; corner < 2; ++corner) {
        V3f at = numbers.vector(-0.2f, 1.2f);
        for (int axis = 0; axis < 3; ++axis) at[axis] = std::min(1.0f, std::max(0.0f, at[axis]));
        box.extendBy(in_box(at));
      }
      if (round % 5 == 0) box.max[child % 3] = box.min[child % 3];
      const V3f opacity = numbers.vector(0, 1);
      by_box.add_uniform(opacity, box);
      by_map.add(uniform_map(opacity), box);
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int cell = 0; cell < kMapCells; ++cell)
        ASSERT_NEAR(by_box.map().transmittance[axis][cell], by_map.map().transmittance[axis][cell],
                    2e-5f)
            << round << ", " << axis << ", " << cell;
  }
}

TEST(CoverageMap, AdjacentSolidPartsFillTheirParentWhereverTheyTouch) {
  for (const float at : {0.5f, 0.25f, 0.37f, 0.501f}) {
    Box3f left = kBox, right = kBox;
    left.max.x = right.min.x = in_box({at, 0, 0}).x;
    NodeCoverage node(kBox);
    node.add_uniform(V3f(1, 1, 1), left);
    node.add_uniform(V3f(1, 1, 1), right);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(node.map().mean_opacity(axis), 1, 1e-5f)
          << "split at " << at << ", axis " << axis;
    }
  }
}

TEST(CoverageMap, PartsThatOverlapWithinACellMultiplyOnlyThere) {
  // Each box has 3/4 of the parent's width, one from the left and one from the right. So they
  // overlap in the middle half.
  Box3f left = kBox, right = kBox;
  left.max.x = in_box({0.75f, 0, 0}).x;
  right.min.x = in_box({0.25f, 0, 0}).x;
  NodeCoverage node(kBox);
  node.add_uniform(V3f(0.5f, 0.5f, 0.5f), left);
  node.add_uniform(V3f(0.5f, 0.5f, 0.5f), right);
  for (const int axis : {1, 2}) {
    EXPECT_NEAR(node.map().mean_opacity(axis), 0.5f * 0.5f + 0.5f * 0.75f, 1e-5f);
  }
}

TEST(CoverageMap, OverlappingChildrenMultiplyAndSolidStaysSolid) {
  NodeCoverage node(kBox);
  node.add_uniform(V3f(0.5f, 0.2f, 0), kBox);
  node.add_uniform(V3f(0.5f, 0.9f, 0), kBox);
  EXPECT_NEAR(node.map().mean_opacity(0), 0.75f, 1e-5f);
  EXPECT_NEAR(node.map().mean_opacity(1), 0.92f, 1e-5f);
  EXPECT_NEAR(node.map().mean_opacity(2), 0, 1e-6f);
  node.add_uniform(V3f(1, 1, 1), kBox);
  node.add_uniform(V3f(0.3f, 0.3f, 0.3f), kBox);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(node.map().mean_opacity(axis), 1, 1e-5f);
}

TEST(CoverageMap, AFlatBoxIsOpaqueOnlyAlongItsNormal) {
  Box3f flat = kBox;
  flat.max.z = flat.min.z;
  NodeCoverage node(kBox);
  node.add_uniform(V3f(0.8f, 0.8f, 0.8f), flat);
  EXPECT_NEAR(node.map().mean_opacity(0), 0, 1e-6f);
  EXPECT_NEAR(node.map().mean_opacity(1), 0, 1e-6f);
  EXPECT_NEAR(node.map().mean_opacity(2), 0.8f, 1e-5f);
}

Texture noise_texture(std::uint32_t width, std::uint32_t height, unsigned seed) {
  Texture texture;
  texture.width = width;
  texture.height = height;
  texture.nearest = true;  // cut along texels
  std::mt19937 random(seed);
  for (std::uint32_t i = 0; i < width * height; ++i) {
    // Alpha increases to the right, so that a mean over the wrong texels is noticed.
    texture.alpha.push_back(
        static_cast<std::uint8_t>((random() % 128) + 127 * (i % width) / width));
  }
  return texture;
}

double texture_mean(const Texture& texture, float cutoff) {
  double sum = 0;
  for (const std::uint8_t a : texture.alpha) {
    sum += cutoff < 0 ? a / 255.0 : a / 255.0 >= cutoff ? 1.0 : 0.0;
  }
  return sum / static_cast<double>(texture.alpha.size());
}

TEST(OpacityMipLevels, ItsTopIsTheMeanOfAllTexelsOfOddSizesToo) {
  for (const auto& [width, height] : {std::pair{64u, 64u}, {1u, 1u}, {37u, 5u}, {3u, 100u}}) {
    const Texture texture = noise_texture(width, height, 6);
    for (const float cutoff : {-1.0f, 0.5f}) {
      // From 100 texels to one there are at most seven mip levels, each of which rounds.
      EXPECT_NEAR(OpacityMipLevels(texture, 1, cutoff).mean({0.3f, 0.8f}, 1e6f),
                  texture_mean(texture, cutoff), 1e-5)
          << width << " x " << height << ", cutoff " << cutoff;
    }
  }
}

TEST(OpacityMipLevels, AMeanOverOneTexelIsThatTexel) {
  const Texture texture = noise_texture(16, 8, 7);
  const OpacityMipLevels mip_levels(texture, 0.5f, -1);
  for (std::uint32_t y = 0; y < 8; ++y) {
    for (std::uint32_t x = 0; x < 16; ++x) {
      const V2f uv((static_cast<float>(x) + 0.5f) / 16, (static_cast<float>(y) + 0.5f) / 8);
      EXPECT_NEAR(mip_levels.mean(uv, 1), 0.5f * texture.alpha[y * 16 + x] / 255.0f, 1e-6f);
    }
  }
}

TEST(OpacityMipLevels, CutOutsAreThresholdedBeforeTheyAreAveraged) {
  Texture checks;
  checks.width = checks.height = 4;
  checks.nearest = true;
  for (int i = 0; i < 16; ++i) checks.alpha.push_back((i + i / 4) % 2 ? 204 : 51);  // 0.8, 0.2
  const auto mean = [&](float factor, float cutoff) {
    return OpacityMipLevels(checks, factor, cutoff).mean({0.5f, 0.5f}, 4);
  };
  EXPECT_NEAR(mean(1, -1), 0.5f, 1e-6f);
  EXPECT_NEAR(mean(1, 0.6f), 0.5f, 1e-6f);  // the mean, 0.5, is below the cutoff
  EXPECT_NEAR(mean(1, 0.1f), 1, 1e-6f);
  EXPECT_NEAR(mean(1, 0.9f), 0, 1e-6f);
  EXPECT_NEAR(mean(0.5f, 0.45f), 0, 1e-6f);  // the factor is applied before the threshold
}

TEST(OpacityMipLevels, AnAlphaThatEqualsTheCutoffIsOpaque) {
  EXPECT_EQ(thresholded(0.5f, 0.5f), 1.0f);
  EXPECT_EQ(thresholded(0.0f, 0.0f), 1.0f);
  Texture half;
  half.width = half.height = 2;
  half.nearest = true;
  half.alpha = {0, 0, 255, 255};
  EXPECT_EQ(OpacityMipLevels(half, 1, 0).mean({0.5f, 0.5f}, 2), 1.0f);
  EXPECT_EQ(OpacityMipLevels(half, 1, 1).mean({0.5f, 0.5f}, 2), 0.5f);
}

// Factors of corners are interpolated before the cut: 0.8 (1 - w) is at least the cutoff.
TEST(OpacityMipLevels, ACutOutCountsTheAlphasOfAllThreeCorners) {
  Scene scene;
  scene.textures.push_back({"even", 2, 2, std::vector<std::uint8_t>(4, 204)});  // 0.8
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.alpha_texture = 0;
  scene.materials.push_back(material);
  const auto mean = [&](const std::array<float, 3>& alphas, float cutoff) {
    scene.materials[0].alpha_cutoff = cutoff;
    TexturedCorners corners;
    corners.uv = {V2f(0, 0), V2f(1, 0), V2f(0, 1)};
    corners.alpha = alphas;
    corners.has_texture = true;
    const std::vector<TexturedTriangle> triangle{
        pack_textured(corners, Wrap::repeat, Wrap::repeat)};
    return TextureIntegrals(scene, triangle).of(triangle[0]).mean(0.3f, 0.3f, 1);
  };
  for (const auto& alphas :
       {std::array{0.0f, 1.0f, 1.0f}, {1.0f, 0.0f, 1.0f}, {1.0f, 1.0f, 0.0f}}) {
    EXPECT_NEAR(mean(alphas, 0.5f), 1 - 0.625 * 0.625, 0.03);
    EXPECT_NEAR(mean(alphas, 0.6f), 1 - 0.75 * 0.75, 0.03);
  }
}

TEST(OpacityMipLevels, CoordinatesFarOutWrapToTheirPositionInTheTile) {
  for (const auto& [s, t] : {std::pair{Wrap::repeat, Wrap::repeat},
                             {Wrap::repeat, Wrap::clamp},
                             {Wrap::mirror, Wrap::clamp},
                             {Wrap::clamp, Wrap::clamp}}) {
    Texture texture = noise_texture(16, 8, 9);
    texture.wrap_s = s;
    texture.wrap_t = t;
    const OpacityMipLevels mip_levels(texture, 1, -1);
    // 3e9 is an even number of whole tiles; clamped coordinates are beyond the last texel.
    const float u = s == Wrap::clamp ? 1.0f : 0.0f, v = t == Wrap::clamp ? 1.0f : 0.0f;
    EXPECT_NEAR(mip_levels.mean({3e9f, 0.3f}, 1), mip_levels.mean({u, 0.3f}, 1), 1e-6f);
    EXPECT_NEAR(mip_levels.mean({0.3f, 3e9f}, 1), mip_levels.mean({0.3f, v}, 1), 1e-6f);
  }
}

/// A square metre perpendicular to z, as two triangles. The texture covers it once.
Scene card_scene(const Texture& texture, AlphaMode mode, float alpha) {
  Scene scene;
  scene.textures.push_back(texture);
  Material material;
  material.alpha_mode = mode;
  material.alpha = alpha;
  material.alpha_texture = 0;
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.materials = {0, 0};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({0, M44f(), -1});
  return scene;
}

TEST(CoverageMap, ATexturedCardsMeanIsItsTexturesMean) {
  for (const std::uint32_t size : {8u, 64u, 257u}) {
    const Texture texture = noise_texture(size, size, 8);
    for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
      const float alpha = mode == AlphaMode::blend ? 0.6f : 1.0f;
      const Scene scene = card_scene(texture, mode, alpha);
      BuiltObject built = build_object(scene, OpaqueTexels(scene), scene.meshes[0]);
      prefilter(built, TextureIntegrals(scene, built.object.textured));
      const ObjectBvh& object = built.object;
      const double truth = alpha * texture_mean(texture, mode == AlphaMode::mask ? 0.5f : -1.0f);
      // The opacities of the two triangles add up. Three errors are small: the blur between two
      // mip levels, the wrap at the border, and the look-up in the middle of cells that
      // the diagonal divides.
      EXPECT_NEAR(object.opacity.axes.z, truth, 0.004) << size << " texels";
      EXPECT_NEAR(object.opacity.axes.x, 0, 1e-6f);
      EXPECT_NEAR(object.opacity.axes.y, 0, 1e-6f);
    }
  }
}

}  // namespace
}  // namespace dapple
