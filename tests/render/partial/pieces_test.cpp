// Pieces of a picture: which overlap, what is missing, and that joining them loses nothing.
#include "render/partial/pieces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace dapple {
namespace {

constexpr PixelRect kWhole{0, 0, 9, 5};

TEST(Shard, RangesOfAnyCountsCoverAllRaysOnce) {
  for (const int spp : {1, 2, 7, 16, 1000}) {
    for (int count = 1; count <= std::min(spp, 40); ++count) {
      std::uint32_t next = 0;
      for (int index = 1; index <= count; ++index) {
        const RayRange rays = rays_of({index, count}, spp);
        EXPECT_EQ(rays.first, next);
        EXPECT_GT(rays.end, rays.first) << "no shard is empty";
        EXPECT_LE(rays.end - rays.first, static_cast<std::uint32_t>(spp / count + 1));
        next = rays.end;
      }
      EXPECT_EQ(next, static_cast<std::uint32_t>(spp));
    }
  }
  EXPECT_EQ(rays_of({1, 2}, 1 << 20).end, 1u << 19);
  EXPECT_EQ(rays_of({2, 4}, 13).end, rays_of({1, 2}, 13).end) << "2/4 ends where 1/2 does";
}

TEST(Pieces, OverlapInPixelsAndSamples) {
  const Piece a{{2, 2, 5, 5}, {4, 8}};
  EXPECT_TRUE(overlap(a, a));
  EXPECT_TRUE(overlap(a, {{5, 5, 9, 9}, {7, 9}}));
  EXPECT_FALSE(overlap(a, {{6, 2, 9, 5}, {4, 8}})) << "the next columns";
  EXPECT_FALSE(overlap(a, {{2, 6, 5, 9}, {4, 8}})) << "the next rows";
  EXPECT_FALSE(overlap(a, {{2, 2, 5, 5}, {8, 9}})) << "the next samples";
}

TEST(Pieces, OfAGridAndOfShardsJoinToOneInAnyOrder) {
  std::vector<Piece> pieces;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x)
      for (std::uint32_t s = 0; s < 4; ++s)
        pieces.push_back({{2 * x, 2 * y, 2 * x + 1, 2 * y + 1}, {4 * s, 4 * s + 4}});
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    std::shuffle(pieces.begin(), pieces.end(), random);
    EXPECT_EQ(joined(pieces), (std::vector<Piece>{{kWhole, {0, 16}}}));
    EXPECT_EQ(missing_text(pieces, 16), "");
  }
}

TEST(Pieces, WhatIsMissingIsSaidInSamplesAndPixels) {
  EXPECT_EQ(missing_text({{kWhole, {0, 4}}, {kWhole, {8, 12}}}, 16),
            "samples 5 to 8, samples 13 to 16 of 16");
  EXPECT_EQ(missing_text({{kWhole, {0, 15}}}, 16), "sample 16 of 16");
  EXPECT_EQ(missing_text({{{0, 0, 9, 2}, {0, 8}}, {{0, 3, 9, 5}, {0, 4}}}, 8),
            "samples 5 to 8 of 8 of the pixels 0,3 to 9,5");
  EXPECT_EQ(missing_text({{{0, 0, 4, 2}, {0, 8}}, {{5, 3, 9, 5}, {0, 8}}}, 8), "30 of 60 pixels");
}

// Pieces join differently from sample to sample: every pixel counts by what it lacks itself.
TEST(Pieces, WhatIsMissingIsSaidForCropsThatDifferFromShardToShard) {
  const PixelRect left{0, 0, 4, 5}, right{5, 0, 9, 5};
  EXPECT_EQ(missing_text({{left, {0, 4}}, {left, {4, 8}}, {right, {0, 4}}}, 8),
            "samples 5 to 8 of 8 of the pixels 5,0 to 9,5");
  EXPECT_EQ(missing_text({{kWhole, {0, 4}}, {{0, 0, 9, 4}, {4, 8}}}, 8),
            "samples 5 to 8 of 8 of the pixels 0,5 to 9,5");
  EXPECT_EQ(missing_text({{left, {0, 8}}, {{5, 0, 9, 2}, {0, 4}}, {{5, 3, 9, 4}, {0, 8}}}, 8),
            "samples 5 to 8 of 8 of the pixels 5,0 to 9,2; 5 of 60 pixels");
  const std::vector<Piece> pinwheel{{{0, 0, 5, 1}, {0, 4}}, {{6, 0, 9, 3}, {0, 4}},
                                    {{3, 4, 9, 5}, {0, 4}}, {{0, 2, 2, 5}, {0, 4}},
                                    {{3, 2, 5, 3}, {0, 4}}, {kWhole, {4, 8}}};
  EXPECT_EQ(missing_text(pinwheel, 8), "");
  EXPECT_EQ(joined(pinwheel), (std::vector<Piece>{{kWhole, {0, 8}}})) << "it can be resumed";
}

TEST(Pieces, OutsideOfTheCropOrEmptyAreNone) {
  EXPECT_TRUE(is_piece_of(kWhole, {kWhole, {0, 1}}));
  for (const Piece& piece :
       {Piece{{0, 0, 10, 5}, {0, 1}}, Piece{{-1, 0, 9, 5}, {0, 1}}, Piece{{4, 0, 3, 5}, {0, 1}},
        Piece{kWhole, {1, 1}}, Piece{kWhole, {0, (1 << 20) + 1}}})
    EXPECT_FALSE(is_piece_of(kWhole, piece));
}

}  // namespace
}  // namespace dapple
