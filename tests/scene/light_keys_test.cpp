// Every key of every type of light in a lights file: with a good value, without the key, with a
// value of another type, and with NaN or a number that no float holds.
#include <map>
#include <set>
#include <sstream>

#include "support/files/lights_text.hpp"

namespace dapple {
namespace {

using namespace lights_test;

struct Key {
  std::string name, good, wrong_type;
  bool required = true;
};

struct Type {
  std::string name;
  std::vector<Key> keys;
};

const std::string kText = "\"x\"", kNumber = "3";

Key point(const std::string& name) { return {name, "[1, 2, 3]", "[1, true, 3]"}; }
Key length(const std::string& name) { return {name, "0.5", kText}; }
Key optional(Key key) {
  key.required = false;
  return key;
}

std::vector<Type> every_type() {
  const Key radiance{"radiance", "[1, 2, 0.5]", kText};
  std::vector<Type> types = {
      {"rect", {point("position"), point("normal"), {"size", "[1, 2]", "[1, \"x\"]"}, radiance}},
      {"disk", {point("position"), point("normal"), length("radius"), radiance}},
      {"sphere", {point("position"), length("radius"), radiance}},
      {"spot",
       {point("position"), point("direction"), length("radius"), radiance,
        optional(length("inner_degrees")), optional(length("outer_degrees"))}},
      {"sun", {point("direction"), radiance, optional(length("angle_degrees"))}},
      {"dome", {optional(radiance), optional(length("rotation_degrees"))}},
  };
  for (Type& type : types) {
    for (const Key& common : {Key{"name", kText, kNumber}, Key{"group", "\"g\"", kNumber},
                              Key{"enabled", "true", "\"yes\""}, Key{"exposure", "-2.5", kText}})
      type.keys.push_back(optional(common));
  }
  // "target" in place of the direction, and "irradiance" in place of the sun's radiance.
  std::vector<Type> variants;
  for (const Type& type : types) {
    Type variant = type;
    bool differs = false;
    for (Key& key : variant.keys) {
      const std::string old = key.name;
      if (key.name == "normal" || (key.name == "direction" && type.name == "spot"))
        key = {"target", "[1, 2, -3]", kText};
      if (key.name == "radiance" && type.name == "sun") key.name = "irradiance";
      differs = differs || key.name != old;
    }
    if (differs) variants.push_back(variant);
  }
  types.insert(types.end(), variants.begin(), variants.end());
  return types;
}

/// The light's keys, with `replaced` in place of the value of `key`; empty: without the key.
std::string light_text(const Type& type, const std::string& key, const std::string& replaced) {
  std::string text = "\"type\": \"" + type.name + "\"";
  for (const Key& each : type.keys) {
    const std::string& value = each.name == key ? replaced : each.good;
    if (!value.empty()) text += ", \"" + each.name + "\": " + value;
  }
  return text;
}

TEST(LightKeys, GoodValuesOfAllKeysMakeALight) {
  for (const Type& type : every_type())
    EXPECT_EQ(load_one(light_text(type, "", "")).size(), 1u) << type.name;
}

TEST(LightKeys, WhatIsMissingIsNamedOrHasADefault) {
  for (const Type& type : every_type()) {
    for (const Key& key : type.keys) {
      SCOPED_TRACE(type.name + " without " + key.name);
      const std::string text = light_text(type, key.name, "");
      if (!key.required) {
        EXPECT_EQ(load_one(text).size(), 1u);
        continue;
      }
      const std::string message = complaint_about(text);
      EXPECT_EQ(message.find("light 1 (\"x\"): "), 0u) << message;
      EXPECT_TRUE(message.find(key.name) != std::string::npos) << message;
      EXPECT_NE(message.find("is missing"), std::string::npos) << message;
    }
  }
}

TEST(LightKeys, AValueOfAnotherTypeIsRefusedWithTheKeysName) {
  for (const Type& type : every_type()) {
    for (const Key& key : type.keys) {
      for (const std::string& wrong : {key.wrong_type, std::string("null"), std::string("{}")}) {
        SCOPED_TRACE(type.name + " with " + key.name + " = " + wrong);
        const std::string message = complaint_about(light_text(type, key.name, wrong));
        EXPECT_NE(message.find(": " + key.name), std::string::npos) << message;
        EXPECT_NE(message.find(" must be "), std::string::npos) << message;
      }
    }
  }
}

TEST(LightKeys, NaNAndNumbersThatNoFloatHoldsAreRefused) {
  for (const Type& type : every_type()) {
    for (const Key& key : type.keys) {
      const bool three = key.good.starts_with("[1, 2, "), two = key.good == "[1, 2]";
      for (const std::string& number :
           {std::string("NaN"), std::string("1e39"), std::string("1e999")}) {
        const std::string value = three ? "[0, " + number + ", 0]"
                                  : two ? "[1, " + number + "]"
                                        : number;
        SCOPED_TRACE(type.name + " with " + key.name + " = " + value);
        const std::string message = complaint_about(light_text(type, key.name, value));
        const bool named = message.find(": " + key.name) != std::string::npos;
        const bool parse_error = message.find("parse error") == 0 || message.find("number") == 0;
        EXPECT_TRUE(number == "1e39" ? named : parse_error) << message;
      }
    }
  }
}

// Two keys that are not in the table above: the type itself, and the image of a dome.
TEST(LightKeys, TypesAndImagesAreTextThatMeansSomething) {
  for (const char* wrong : {"3", "null", "[]", "true"}) {
    EXPECT_EQ(complaint_about(std::string("\"type\": ") + wrong), "light 1: type must be a string");
    EXPECT_EQ(complaint_about(std::string("\"type\": \"dome\", \"image\": ") + wrong),
              "light 1: image must be a string");
  }
  for (const char* key : {"\"type\": NaN", "\"type\": \"dome\", \"image\": NaN"})
    EXPECT_EQ(complaint_about(key).find("parse error"), 0u) << complaint_about(key);
  EXPECT_EQ(complaint_about("\"radiance\": 1"), "light 1: type is missing");
  EXPECT_EQ(complaint_about("\"type\": \"NaN\""),
            "light 1: type \"NaN\" is not rect, disk, sphere, spot, sun or dome");
  const std::string dome = R"("type": "dome", "name": "x", "image": )";
  EXPECT_EQ(complaint_about(dome + R"("")"), "light 1 (\"x\"): image must not be empty");
  const std::string missing = complaint_about(dome + R"("no such file.exr")");
  EXPECT_EQ(missing.find("light 1 (\"x\"): image "), 0u) << missing;
  EXPECT_NE(missing.find("no such file.exr: no such dome image"), std::string::npos) << missing;
}

// Limits are doubles and values floats: what a file calls the limit is within it.
TEST(LightKeys, TheLimitsThemselvesAreAllowed) {
  const std::string sun = R"("type": "sun", "direction": [0, 1, 0], "irradiance": 1, )";
  EXPECT_EQ(load_one(sun + R"("angle_degrees": 0.0001)").size(), 1u);
  EXPECT_EQ(load_one(sun + R"("angle_degrees": 179.999)").size(), 1u);
  const std::string sphere = R"("type": "sphere", "position": [1e12, -1e12, 0], )";
  EXPECT_EQ(load_one(sphere + R"("radius": 1e-9, "radiance": 1e30)").size(), 1u);
  EXPECT_EQ(load_one(sphere + R"("radius": 1e12, "radiance": [1e30, 0, 1e30])").size(), 1u);
  EXPECT_NE(complaint_about(sphere + R"("radius": 0.9e-9, "radiance": 1)").find("radius must be"),
            std::string::npos);
  EXPECT_NE(
      complaint_about(sphere + R"("radius": 1, "radiance": 1.1e30)").find("radiance is above"),
      std::string::npos);
}

/// The keys that a message of an unknown one lists: "...; known: name, type, group".
std::set<std::string> known_keys(const std::string& message) {
  static const std::string begin = "\"colour\" is not known here; known: ";
  const std::size_t found = message.find(begin);
  EXPECT_NE(found, std::string::npos) << message;
  std::set<std::string> keys;
  if (found == std::string::npos) return keys;
  std::istringstream list(message.substr(found + begin.size()));
  for (std::string key; std::getline(list >> std::ws, key, ',');) keys.insert(key);
  return keys;
}

// A key that is added to a light has to be added to the table above, too.
TEST(LightKeys, AKeyOfAnotherTypeIsRefusedWithTheKnownOnesWhichAreAllTested) {
  std::map<std::string, std::set<std::string>> tested;
  for (const Type& type : every_type()) {
    tested[type.name].insert("type");
    for (const Key& key : type.keys) tested[type.name].insert(key.name);
  }
  tested["dome"].insert("image");
  for (const Type& type : every_type()) {
    const std::string text = light_text(type, "", "") + ", \"colour\": [1, 1, 1]";
    EXPECT_EQ(known_keys(complaint_about(text)), tested[type.name]) << type.name;
  }
}

}  // namespace
}  // namespace dapple
