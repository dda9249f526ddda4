// Media types of images: how a file begins decides, and its name where that says nothing.
#include "scene/images/media_type.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace dapple {
namespace {

std::string type_of(const std::string& begin, const std::string& name) {
  const std::string bytes = begin + std::string(16, '\0');
  return image_media_type(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), name);
}

TEST(MediaType, ComesFromTheSignature) {
  EXPECT_EQ(type_of("\x89PNG\r\n\x1a\n", "a.jpg"), "image/png");
  EXPECT_EQ(type_of("\xff\xd8\xff\xe0", "a.png"), "image/jpeg");
  EXPECT_EQ(type_of("RIFF1234WEBPVP8L", "a.png"), "image/webp");
  EXPECT_EQ(type_of("\xabKTX 20\xbb\r\n\x1a\n", "a.png"), "image/ktx2");
  EXPECT_EQ(type_of("DDS |", "a.png"), "image/vnd-ms.dds");
  for (const char* begin : {"1234ftypavif", "1234ftypavis"})
    EXPECT_EQ(type_of(begin, "a.png"), "image/avif");
}

TEST(MediaType, OfOtherBytesComesFromTheName) {
  EXPECT_EQ(type_of("1234", "folder.png/a.WebP"), "image/webp");
  EXPECT_EQ(type_of("RIFF1234WAVE", "a.jpeg"), "image/jpeg");
  EXPECT_EQ(type_of("1234", "a"), "image/png");
  EXPECT_EQ(image_media_type({}, "a.ktx2"), "image/ktx2");
}

}  // namespace
}  // namespace dapple
