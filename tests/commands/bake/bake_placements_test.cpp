// Bakes of meshes that several nodes place: parts of one mesh that its lights divide have no seam,
// and a mesh in several poses has the mean over its instances.
#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

/// A square that faces up: its extent along x, its height, and half its extent along z.
struct Square {
  float left, right, y, depth;
};

/// Vertices 0 and 1 are at the left, 2 and 3 at the right, and 0 and 3 behind.
json primitive_of(GltfBuilder& builder, const Square& square) {
  const auto [left, right, y, depth] = square;
  const int position =
      builder.add_positions({left, y, -depth, left, y, depth, right, y, depth, right, y, -depth});
  builder.doc["accessors"][position]["min"] = {left, y, -depth};
  builder.doc["accessors"][position]["max"] = {right, y, depth};
  const int indices =
      builder.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, test::kUint16, "SCALAR");
  return {{"attributes", {{"POSITION", position}}}, {"indices", indices}};
}

void place(GltfBuilder& builder, std::size_t mesh, const json& translation) {
  builder.add("nodes", {{"mesh", mesh}, {"translation", translation}});
}

class BakePlacements : public BakeCommand {
 protected:
  /// _AO of each vertex, by mesh and primitive.
  [[nodiscard]] std::vector<std::vector<std::vector<float>>> baked_ao(
      const GltfBuilder& builder) const {
    write("in.glb", builder.glb());
    const Outcome run = dapple("bake in.glb -o out.glb --channel _AO --sides front --rays 1024");
    EXPECT_EQ(run.code, 0) << run.err;
    std::vector<std::vector<std::vector<float>>> ao;
    const test::GltfData file(path("out.glb"));
    for (const json& mesh : file.doc["meshes"]) {
      ao.emplace_back();
      for (const json& primitive : mesh["primitives"])
        ao.back().push_back(file.floats(primitive["attributes"]["_AO"]));
    }
    return ao;
  }
};

/// A floor of two squares that meet at x = 0, the right one emits light and lies under a roof; all
/// that twice, far from each other. The squares are primitives of one mesh, or meshes.
GltfBuilder two_floors(bool one_mesh) {
  GltfBuilder builder;
  builder.add("materials", {{"name", "tile"}});
  builder.add("materials", {{"name", "lamp"}, {"emissiveFactor", {0.1, 0.1, 0.1}}});
  json left = primitive_of(builder, {-1, 0, 0, 1}), right = primitive_of(builder, {0, 1, 0, 1});
  left["material"] = 0;
  right["material"] = 1;
  if (one_mesh) {
    builder.add("meshes", {{"primitives", {left, right}}});
  } else {
    builder.add("meshes", {{"primitives", {left}}});
    builder.add("meshes", {{"primitives", {right}}});
  }
  builder.add("meshes", {{"primitives", {primitive_of(builder, {0, 1, 0.05f, 1})}}});
  for (const float x : {0.0f, 50.0f})
    for (std::size_t mesh = 0; mesh < builder.doc["meshes"].size(); ++mesh)
      place(builder, mesh, {x, 0, 0});
  return builder;
}

/// The vertices of a left and a right square at the same place.
constexpr std::array<std::pair<std::size_t, std::size_t>, 2> kBorder = {{{2, 1}, {3, 0}}};

TEST_F(BakePlacements, PartsOfAMeshThatItsLightDividesHaveOneValueAtTheirBorder) {
  const auto floor = baked_ao(two_floors(true))[0];
  ASSERT_EQ(floor.size(), 2u);
  for (const auto& [left, right] : kBorder) EXPECT_EQ(floor[0][left], floor[1][right]);
  // The roof covers one of the squares, so that the border's value is between those beside it.
  EXPECT_GT(floor[0][0], floor[0][3] + 0.1f);
  EXPECT_LT(floor[1][3], floor[1][0] - 0.1f);
  const auto meshes = baked_ao(two_floors(false));
  for (const auto& [left, right] : kBorder)
    EXPECT_GT(meshes[0][0][left], meshes[1][0][right] + 0.1f) << "meshes have their own values";
}

/// A square whose weight moves it by a tenth of a millimetre: nine times in the open without that
/// weight, and once with it under a roof, one centimetre above.
GltfBuilder ten_squares() {
  GltfBuilder builder;
  json square = primitive_of(builder, {-0.1f, 0.1f, 0, 0.1f});
  const int shift = builder.add_positions({0, 1e-4f, 0, 0, 1e-4f, 0, 0, 1e-4f, 0, 0, 1e-4f, 0});
  builder.doc["accessors"][shift]["min"] = builder.doc["accessors"][shift]["max"] = {0, 1e-4f, 0};
  square["targets"] = {{{"POSITION", shift}}};
  builder.add("meshes", {{"primitives", {square}}, {"weights", {0}}});
  builder.add("meshes", {{"primitives", {primitive_of(builder, {-0.3f, 0.3f, 0.01f, 0.3f})}}});
  for (int i = 1; i <= 9; ++i) place(builder, 0, {10 * i, 0, 0});
  builder.add("nodes", {{"mesh", 0}, {"weights", {1}}});
  place(builder, 1, {0, 0, 0});
  return builder;
}

// AO is 1 in the open. Under the roof, each of whose four edges is at least d = 0.2 away and
// h = 0.01 above, (1 - d / sqrt(d^2 + h^2)) / 2 = 0.0006 of the cosine-weighted hemisphere is past
// an edge at most. The mean over ten instances is 0.9, and less than 4 * 0.0006 / 10 more.
TEST_F(BakePlacements, AMeshInSeveralPosesHasTheMeanOverItsInstances) {
  const auto square = baked_ao(ten_squares())[0][0];
  ASSERT_EQ(square.size(), 4u);
  for (const float ao : square) EXPECT_NEAR(ao, 0.9f, 0.001f);
}

}  // namespace
}  // namespace dapple
