// What edits of a glTF document left without use is dropped, and all else refers to what it did.
#include "scene/gltf/edit/compaction.hpp"

#include <gtest/gtest.h>

#include <tuple>

namespace dapple::gltf {
namespace {

/// A bufferView of sixteen bytes.
Json view_at(int offset) { return {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", 16}}; }

/// Six accessors: 0 positions, 1 colours, 2 of a skin, 3 and 4 of an animation, 5 without use. View
/// 6 is an image's. Each view has sixteen bytes of one letter.
Json document() {
  Json json;
  json["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"material", 0}}}}}};
  json["skins"] = {{{"inverseBindMatrices", 2}}};
  json["animations"] = {{{"samplers", {{{"input", 3}, {"output", 4}}}}}};
  for (int i = 0; i < 6; ++i) json["accessors"].push_back({{"bufferView", i}, {"name", i}});
  for (int i = 0; i < 7; ++i) json["bufferViews"].push_back(view_at(16 * i));
  json["images"] = {{{"bufferView", 6}}};
  json["textures"] = {{{"source", 0}}};
  json["materials"] = {{{"occlusionTexture", {{"index", 0}}}}};
  return json;
}

std::string binary_of(int views) {
  std::string bytes;
  for (int i = 0; i < views; ++i) bytes += std::string(16, static_cast<char>('a' + i));
  return bytes;
}

/// The letter of the bytes that an accessor or an image has.
char letter_of(const Json& json, const Json& element, const std::string& binary) {
  const Json& view = json["bufferViews"].at(element["bufferView"].get<std::size_t>());
  const std::string bytes = binary.substr(view["byteOffset"], view["byteLength"]);
  EXPECT_EQ(bytes, std::string(16, bytes[0]));
  return bytes[0];
}

/// Adds an accessor with sixteen bytes of its own, as an editor does. Returns its index.
std::size_t add_accessor(Json& json, std::string& binary) {
  const auto views = static_cast<int>(json["bufferViews"].size());
  json["bufferViews"].push_back(view_at(16 * views));
  binary += std::string(16, static_cast<char>('a' + views));
  json["accessors"].push_back({{"bufferView", views}, {"name", "new"}});
  return json["accessors"].size() - 1;
}

TEST(Compaction, ANewAccessorTakesThePlaceOfTheOneThatLostItsUse) {
  const Json before = document();
  Json after = before;
  std::string binary = binary_of(7);
  Json& attributes = after["meshes"][0]["primitives"][0]["attributes"];
  attributes["COLOR_0"] = add_accessor(after, binary);
  drop_unused(before, after, binary);
  EXPECT_EQ(attributes["COLOR_0"], 1);
  ASSERT_EQ(after["accessors"].size(), 6u);
  ASSERT_EQ(after["bufferViews"].size(), 7u);
  EXPECT_EQ(binary.size(), 7u * 16);
  const char* const letters = "ahcdef";  // f: of the one that had no use before
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(letter_of(after, after["accessors"][i], binary), letters[i]) << i;
  EXPECT_EQ(letter_of(after, after["images"][0], binary), 'g');
  for (const char* array : {"skins", "animations", "textures", "materials"})
    EXPECT_EQ(after[array], before[array]);
}

TEST(Compaction, WithoutANewOneWhatComesLaterKeepsItsIndex) {
  const Json before = document();
  Json after = before;
  std::string binary = binary_of(7);
  after["meshes"][0]["primitives"][0]["attributes"].erase("COLOR_0");
  const Json edited = after;
  drop_unused(before, after, binary);
  EXPECT_EQ(after, edited);
  EXPECT_EQ(binary, binary_of(7));
}

TEST(Compaction, AnImageGoesWithItsTexture) {
  const Json before = document();
  Json after = before;
  std::string binary = binary_of(8);
  after["bufferViews"].push_back(view_at(112));
  after["images"].push_back({{"bufferView", 7}});
  after["samplers"].push_back({{"wrapS", 33071}});
  after["textures"].push_back({{"source", 1}, {"sampler", 0}});
  after["materials"][0]["occlusionTexture"]["index"] = 1;
  drop_unused(before, after, binary);
  EXPECT_EQ(after["materials"], before["materials"]);
  EXPECT_EQ(after["textures"], Json::parse(R"([{"source": 0, "sampler": 0}])"));
  ASSERT_EQ(after["images"].size(), 1u);
  EXPECT_EQ(letter_of(after, after["images"][0], binary), 'h');
  EXPECT_EQ(binary.size(), 7u * 16);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(letter_of(after, after["accessors"][i], binary), "abcdef"[i]) << i;
}

TEST(Compaction, BytesThatAnotherViewHasStay) {
  Json before = document();
  before["bufferViews"][0]["byteLength"] = 24;  // half of the colours
  Json after = before;
  std::string binary = binary_of(7);
  after["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = add_accessor(after, binary);
  drop_unused(before, after, binary);
  EXPECT_EQ(binary, std::string(16, 'a') + std::string(8, 'b') + binary_of(8).substr(32));
  EXPECT_EQ(letter_of(after, after["accessors"][1], binary), 'h');
  EXPECT_EQ(letter_of(after, after["accessors"][2], binary), 'c');
}

// The later one goes first.
TEST(Compaction, TheLastOnesGoWithoutNewOnes) {
  Json before = document();
  before["meshes"][0]["primitives"][0]["attributes"]["_A"] = 5;
  before.erase("images");
  before.erase("textures");
  before["bufferViews"].erase(6);
  Json after = before;
  std::string binary = binary_of(6);
  after["meshes"][0]["primitives"][0]["attributes"].erase("_A");
  after.erase("animations");
  drop_unused(before, after, binary);
  EXPECT_EQ(after["accessors"].size(), 3u);
  EXPECT_EQ(after["bufferViews"].size(), 3u);
  EXPECT_EQ(binary, binary_of(3));
}

// An image that another editing step added goes with its bytes.
TEST(Compaction, WhatIsNewAndHasNoUseGoesToo) {
  const Json before = document();
  Json after = before;
  std::string binary = binary_of(7);
  std::ignore = add_accessor(after, binary);
  drop_unused(before, after, binary);
  EXPECT_EQ(after, before);
  EXPECT_EQ(binary, binary_of(7));
}

TEST(Compaction, NothingIsDroppedBesideAnUnknownExtension) {
  for (const bool listed : {true, false}) {
    Json before = document();
    if (listed)
      before["extensionsUsed"] = {"KHR_materials_sheen", "ACME_wind"};
    else
      before["meshes"][0]["extensions"]["ACME_wind"] = {{"accessor", 1}};
    Json after = before;
    std::string binary = binary_of(7);
    after["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = add_accessor(after, binary);
    const Json edited = after;
    drop_unused(before, after, binary);
    EXPECT_EQ(after, edited);
    EXPECT_EQ(binary, binary_of(8));
  }
}

}  // namespace
}  // namespace dapple::gltf
