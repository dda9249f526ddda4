// Scenes with very small and very large numbers: each gives a picture of finite pixels or an Error
// of kind input. Inside the promised range each gives a picture.
#include "scene/check/numeric_range.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "corpus/stage.hpp"
#include "dapple/render.hpp"

namespace dapple::test {
namespace {

constexpr const char* kMayBeInfinite = "Z";  // infinite where no ray hits

/// The name of a channel with a pixel that is not finite; empty when there is none.
std::string odd_channel(const Film& film) {
  for (const Plane& plane : film.planes) {
    if (plane.channel == kMayBeInfinite) continue;
    for (const float value : plane.pixels)
      if (!std::isfinite(value)) return plane.channel;
  }
  return "";
}

RenderOptions small_options() {
  RenderOptions options;
  options.width = options.height = 8;
  options.spp = 4;
  return options;
}

Scene scaled_stage(float scale) {
  GltfBuilder builder;
  auto positions = kCardTriangles;
  for (float& value : positions) value *= scale;
  builder.add_mesh({{"attributes", {{"POSITION", builder.add_positions(positions)}}}});
  return builder.load();
}

/// Renders the scene. Returns "picture", or the message of the Error, which must be of kind input.
std::string outcome(Scene scene, const RenderOptions& options = small_options()) {
  try {
    const RenderResult result = render(std::move(scene), options);
    EXPECT_EQ(odd_channel(result.film), "");
    return "picture";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    return error.what();
  }
}

TEST(NumericRange, ScenesOfEverySizeAreFinitePicturesOrErrors) {
  for (int exponent = -44; exponent <= 38; ++exponent) {
    const auto scale = static_cast<float>(std::pow(10.0, exponent));
    const std::string result = outcome(scaled_stage(scale));
    const bool promised = exponent >= -9 && exponent <= 11;
    EXPECT_EQ(result == "picture", promised) << "1e" << exponent << ": " << result;
  }
}

TEST(NumericRange, OneVertexFarAwayIsAFinitePictureOrAnError) {
  for (const float far : {1e6f, 1e9f, 1e11f, 1e15f, 1e20f, 1e30f, 3e38f}) {
    GltfBuilder builder;
    auto positions = kCardTriangles;
    positions[3] = far;
    builder.add_mesh({{"attributes", {{"POSITION", builder.add_positions(positions)}}}});
    const std::string result = outcome(builder.load());
    EXPECT_EQ(result == "picture", far <= 1e12f) << far << ": " << result;
  }
}

// As files have them whose vertices are map coordinates and whose nodes bring them to the origin.
TEST(NumericRange, MeshesFarFromTheirOwnOriginAreNotedIfTheyArePlacedTwice) {
  for (const std::size_t placements : {1u, 2u}) {
    Scene scene;
    scene.materials.emplace_back();
    Mesh& mesh = scene.meshes.emplace_back();
    for (std::uint32_t t = 0; t < 300; ++t) {
      for (const V3f& corner : {V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0)})
        mesh.positions.push_back(corner + V3f(1e6f, 0, static_cast<float>(t) / 100));
      for (std::uint32_t k = 0; k < 3; ++k) mesh.indices.push_back(3 * t + k);
      mesh.materials.push_back(0);
    }
    for (std::size_t i = 0; i < placements; ++i)
      scene.instances.push_back(
          {0, M44f().setTranslation(V3f(-1e6f + 5 * static_cast<float>(i), 0, 0))});
    check_numeric_range(scene);
    ASSERT_EQ(scene.warnings.size(), placements - 1);
    if (placements > 1) {
      EXPECT_NE(scene.warnings[0].find("from its own origin"), std::string::npos)
          << scene.warnings[0];
    }
  }
}

TEST(NumericRange, LightsAndCamerasFarAwayAreRefusedByName) {
  GltfBuilder builder = plain_stage();
  builder.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"name", "lamp"}, {"type", "point"}}};
  builder.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}},
                        {"translation", {0, 1e20, 0}}});
  expect_says(outcome(builder.load()), "light \"lamp\" reaches 1e+20 m");
  GltfBuilder camera = plain_stage();
  camera.add(
      "cameras",
      {{"name", "moon"}, {"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}});
  camera.add("nodes", {{"camera", 0}, {"translation", {0, 0, 1e30}}});
  expect_says(outcome(camera.load()), "camera \"moon\" reaches 1e+30 m");
}

TEST(NumericRange, LightsOfEveryStrengthAreFinitePictures) {
  for (const double intensity : {0.0, 1e-44, 1e-20, 1.0, 1e10, 1e20, 1e38}) {
    for (const char* type : {"point", "directional"}) {
      GltfBuilder builder = plain_stage();
      builder.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
          {{"type", type}, {"intensity", intensity}}};
      builder.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}},
                            {"translation", {0, 3, 1}}});
      const Scene scene = builder.load();
      EXPECT_EQ(scene.warnings.empty(), intensity < 1e20) << intensity;
      EXPECT_EQ(outcome(scene), "picture") << type << " " << intensity;
    }
  }
}

TEST(NumericRange, EmissionOfEveryStrengthIsAFinitePicture) {
  for (const double strength : {1e-44, 1e-20, 1.0, 1e20, 3e38}) {
    GltfBuilder builder = plain_stage();
    builder.doc["materials"] = {
        {{"emissiveFactor", {1, 1, 1}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", strength}}}}}}};
    builder.doc["meshes"][1]["primitives"][0]["material"] = 0;
    EXPECT_EQ(outcome(builder.load()), "picture") << strength;
  }
}

}  // namespace
}  // namespace dapple::test
