// Which triangles lie in which texels, against each texel cut out of each triangle.
#include "bake/texture/texel_cover.hpp"

#include <gtest/gtest.h>

#include <random>

namespace dapple {
namespace {

/// Clips every triangle to every texel.
TexelCover by_brute_force(std::span<const V2f> corners, std::uint32_t size) {
  TexelCover cover;
  for (std::uint32_t texel = 0; texel < size * size; ++texel) {
    const std::size_t before = cover.triangles.size();
    for (std::uint32_t t = 0; t < corners.size() / 3; ++t)
      if (clip_to_texel(&corners[std::size_t{3} * t], size, texel % size, texel / size).area() >
          1e-6f)
        cover.triangles.push_back(t);
    if (cover.triangles.size() == before) continue;
    cover.texel.push_back(texel);
    cover.first.push_back(static_cast<std::uint32_t>(before));
  }
  cover.first.push_back(static_cast<std::uint32_t>(cover.triangles.size()));
  return cover;
}

void expect_equal(const TexelCover& cover, const TexelCover& expected) {
  EXPECT_EQ(cover.texel, expected.texel);
  EXPECT_EQ(cover.first, expected.first);
  EXPECT_EQ(cover.triangles, expected.triangles);
}

TEST(TexelCover, AgreesWhereFewTexelsFarApartAreCovered) {
  const std::vector<V2f> corners = {{0.95f, 0.02f}, {0.97f, 0.02f}, {0.96f, 0.04f},
                                    {0.01f, 0.93f}, {0.03f, 0.93f}, {0.02f, 0.99f},
                                    {0.02f, 0.03f}, {0.03f, 0.03f}, {0.02f, 0.04f}};
  for (const std::uint32_t size : {130u, 300u}) {
    const TexelCover cover = cover_texels(corners, size);
    expect_equal(cover, by_brute_force(corners, size));
    EXPECT_GT(cover.texel.size(), 8u);
  }
}

TEST(TexelCover, AgreesWithEachTexelCutOutOfEachTriangle) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> anywhere(0, 1), near(-0.03f, 0.03f);
  for (const std::uint32_t size : {1u, 63u, 64u, 150u}) {
    SCOPED_TRACE(size);
    std::vector<V2f> corners = {{0, 0}, {0, 0}, {0, 0}};  // no area
    for (int i = 0; i < 20; ++i) {
      const V2f middle(anywhere(random), anywhere(random));
      for (int k = 0; k < 3; ++k)
        corners.emplace_back(std::clamp(middle.x + near(random), 0.0f, 1.0f),
                             std::clamp(middle.y + near(random), 0.0f, 1.0f));
    }
    corners.insert(corners.end(), {{0.1f, 0.2f}, {0.9f, 0.3f}, {0.4f, 0.95f}});  // across others
    corners.insert(corners.end(), {{1, 1}, {0.99f, 1}, {1, 0.99f}});
    const TexelCover cover = cover_texels(corners, size);
    expect_equal(cover, by_brute_force(corners, size));
    EXPECT_GE(cover.triangles.size(), cover.texel.size());
  }
  expect_equal(cover_texels({}, 64), by_brute_force({}, 64));
}

}  // namespace
}  // namespace dapple
