// Which texture coordinates of a file dapple bake --to texture uses, why not others, and what the
// statistics tell about the texture.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

/// The corners of a unit square in a texture.
struct Rect {
  float left, top, right, bottom;
};

constexpr Rect kFull = {0, 0, 1, 1}, kLeft = {0, 0, 0.5f, 1}, kPoint = {0.5f, 0.5f, 0.5f, 0.5f};

/// A primitive of one unit square, and where it lies in each set of texture coordinates.
using Square = std::vector<Rect>;

class BakeUvSets : public BakeCommand {
 protected:
  /// A file of meshes of squares, all of them in one plane, facing the same way; each mesh has so
  /// many nodes.
  void write_squares(const std::vector<std::vector<Square>>& meshes, int nodes = 1) const {
    GltfBuilder builder;
    float x = 0;
    for (const std::vector<Square>& squares : meshes) {
      json primitives = json::array();
      for (const Square& square : squares) {
        json attributes = {
            {"POSITION", builder.add_positions({x, 0, 0, x + 1, 0, 0, x + 1, 1, 0, x, 1, 0})}};
        for (std::size_t set = 0; set < square.size(); ++set) {
          const auto& [left, top, right, bottom] = square[set];
          attributes["TEXCOORD_" + std::to_string(set)] = builder.add_accessor(
              std::vector<float>{left, top, right, top, right, bottom, left, bottom}, test::kFloat,
              "VEC2");
        }
        const int indices = builder.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3},
                                                 test::kUint16, "SCALAR");
        primitives.push_back({{"attributes", attributes}, {"indices", indices}});
        x += 2;
      }
      const int mesh = builder.add("meshes", {{"primitives", std::move(primitives)}});
      for (int node = 0; node < nodes; ++node)
        builder.add("nodes", {{"mesh", mesh}, {"translation", {0, 0, 9 * node}}});
    }
    write("in.glb", builder.glb());
  }

  /// Bakes in.glb to out.glb; returns what is printed on the standard error.
  [[nodiscard]] std::string notes_of(const std::string& options = "--size 64") const {
    const Outcome run = dapple(
        "bake in.glb -o out.glb --to texture --margin 1 --rays 8 --stats-json s.json " + options);
    EXPECT_EQ(run.code, 0) << run.err;
    return run.err;
  }
  /// "texture" of the statistics.
  [[nodiscard]] json statistics() const {
    return json::parse(bytes_of(path("s.json"))).at("texture");
  }
  /// The set that the occlusion texture of out.glb reads.
  [[nodiscard]] int set_used() const {
    const json doc = document("out.glb");
    const std::size_t material = doc["meshes"][0]["primitives"][0]["material"];
    return doc["materials"][material]["occlusionTexture"]["texCoord"];
  }
};

TEST_F(BakeUvSets, TheSecondIsPreferredToTheFirst) {
  write_squares({{{{0, 0, 1, 0.5f}, {0, 0, 0.25f, 0.5f}}}});
  const std::string notes = notes_of();
  EXPECT_TRUE(contains(notes, "note: the texture uses TEXCOORD_1\n")) << notes;
  EXPECT_EQ(set_used(), 1);
  EXPECT_EQ(statistics()["coverage"], 0.125);
}

TEST_F(BakeUvSets, TheFirstIsUsedWhereTheSecondCannotBe) {
  const Rect upper = {0, 0, 1, 0.25f}, lower = {0, 0.5f, 1, 0.75f}, outside = {0, 0, 1.5f, 1};
  const Rect left = {0, 0, 0.03125f, 0.0625f}, right = {0.03125f, 0, 0.0625f, 0.0625f};
  struct Case {
    Square first, second;
    std::string reason;
  };
  for (const Case& c :
       {Case{{upper, kFull}, {lower, kFull}, "meshes overlap each other in TEXCOORD_1 in 100.0 %"},
        Case{{upper, upper}, {lower, outside}, "TEXCOORD_1 leaves the texture"},
        Case{{upper, upper}, {lower, kPoint}, "TEXCOORD_1 has no area in the texture for 50.0 %"},
        Case{{upper, left}, {lower, right}, "TEXCOORD_1 fills 6.2 % of the texture's width"},
        Case{{upper, upper}, {lower}, "primitive 0 of mesh 1 has no TEXCOORD_1"}}) {
    write_squares({{c.first}, {c.second}});
    const std::string notes = notes_of();
    EXPECT_TRUE(contains(notes, "note: " + c.reason)) << notes;
    EXPECT_TRUE(contains(notes, ": the texture uses TEXCOORD_0\n")) << notes;
    EXPECT_EQ(set_used(), 0);
    EXPECT_EQ(statistics()["coverage"], 0.5);
  }
}

TEST_F(BakeUvSets, CoordinatesOneRoundingOutsideAreUsedAndStayAsTheyAre) {
  const Rect rounded = {-1e-6f, 0, 1.0000001f, 0.5f};
  write_squares({{{kPoint, rounded}}});
  const std::string notes = notes_of();
  EXPECT_TRUE(contains(notes, "note: the texture uses TEXCOORD_1\n")) << notes;
  EXPECT_EQ(statistics()["coverage"], 0.5);
  const auto coordinates = [&](const std::string& name) {
    const test::GltfData file(path(name));
    return file.floats(file.doc["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"]);
  };
  EXPECT_EQ(coordinates("out.glb"), coordinates("in.glb"));
  EXPECT_EQ(coordinates("out.glb")[2], 1.0000001f);
}

TEST_F(BakeUvSets, OverlapsOfOneMeshAndOfSeveralAreSaidInOtherWords) {
  const std::string itself = "TEXCOORD_0 overlaps itself in ",
                    others = "meshes overlap each other in ",
                    replaced = ": the texture has coordinates of its own, TEXCOORD_1\n";
  write_squares({{{kFull}}, {{kFull}}});
  std::string notes = notes_of();
  EXPECT_TRUE(contains(notes, "note: " + others + "TEXCOORD_0 in 100.0 % of its texels (all " +
                                  "share one texture)" + replaced))
      << notes;
  write_squares({{{kFull}, {kFull}}});
  notes = notes_of();
  EXPECT_TRUE(contains(notes, "note: " + itself + "100.0 % of its texels" + replaced)) << notes;
  write_squares({{{kFull}}, {{kLeft}, {kLeft}}});
  notes = notes_of();
  const std::size_t first = notes.find(itself), second = notes.find(", and " + others);
  ASSERT_NE(first, std::string::npos) << notes;
  ASSERT_NE(second, std::string::npos) << notes;
  // A centre on a diagonal is in none of the two triangles: 64 of 4096.
  EXPECT_NEAR(std::stod(notes.substr(first + itself.size())), 50, 1.6) << notes;
  EXPECT_NEAR(std::stod(notes.substr(second + 6 + others.size())), 50, 1.6) << notes;
  EXPECT_TRUE(contains(notes, " % (all share one texture)" + replaced)) << notes;
}

TEST_F(BakeUvSets, CopiesOfAMeshOverlapEachOther) {
  write_squares({{{kFull}}}, 2);
  std::string notes = notes_of();
  EXPECT_TRUE(contains(notes, "note: the texture uses TEXCOORD_0\n")) << notes;
  notes = notes_of("--size 64 --instances unique");
  EXPECT_TRUE(contains(notes, "meshes overlap each other in TEXCOORD_0 in 100.0 %")) << notes;
}

TEST_F(BakeUvSets, OfASquareTheStatisticsHaveItsPartOfTheTexture) {
  write_squares({{{{0, 0, 0.5f, 0.25f}}}});
  const std::string notes = notes_of("--size 16");
  EXPECT_EQ(statistics(),
            json({{"size", 16}, {"charts", 0}, {"coverage", 0.125}, {"overlap", 0.0}}));
  EXPECT_TRUE(contains(notes, "note: triangles cover 12 % of the 16 x 16 texels\n")) << notes;
}

TEST_F(BakeUvSets, OfCoordinatesOfItsOwnTheStatisticsHaveTheCharts) {
  const Square without;
  write_squares({{without}});
  std::string notes = notes_of("--size 16");
  EXPECT_EQ(statistics(), json({{"size", 16}, {"charts", 1}, {"coverage", 1.0}, {"overlap", 0.0}}));
  EXPECT_TRUE(contains(notes, "note: 1 chart covers 100 % of the 16 x 16 texels\n")) << notes;
  write_squares({{without, without}, {without, without}});
  notes = notes_of("--size 64");
  EXPECT_EQ(statistics()["charts"], 4);
  // Two squares beside and above two others, with two texels between them.
  EXPECT_EQ(statistics()["coverage"], 62.0 * 62 / (64 * 64));
  EXPECT_EQ(statistics()["overlap"], 0.0);
}

// Its colour is that of the texel at 0, 0; coordinates of the occlusion would show others.
TEST_F(BakeUvSets, ASetThatAColourTextureReadsInVainIsNotTaken) {
  GltfBuilder builder;
  builder.add_triangle();
  builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
  const int view = builder.add_view(test::png::with_alpha(1, 1, {255}));
  builder.doc["images"] = json::array({{{"bufferView", view}, {"mimeType", "image/png"}}});
  builder.doc["textures"] = json::array({{{"source", 0}}});
  builder.doc["materials"] =
      json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
  write("in.glb", builder.glb());
  const std::string notes = notes_of();
  EXPECT_TRUE(contains(notes, "coordinates of its own, TEXCOORD_1")) << notes;
  EXPECT_EQ(set_used(), 1);
  const test::GltfData file(path("out.glb"));
  const json attributes = file.doc["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(file.floats(attributes["TEXCOORD_0"]), std::vector<float>(6));
  EXPECT_NE(file.floats(attributes["TEXCOORD_1"]), std::vector<float>(6));
}

// Valid files have no such gap. It is filled with zeros: its texture shows the texel at 0, 0.
TEST_F(BakeUvSets, ASetBehindAMissingOneThatATextureNamesIsKept) {
  GltfBuilder builder;
  builder.add_triangle();
  json& primitive = builder.doc["meshes"][0]["primitives"][0];
  const std::vector<float> kept{0, 0, 2, 0, 0, 3};  // leaves the texture
  for (const char* set : {"TEXCOORD_0", "TEXCOORD_2"})
    primitive["attributes"][set] = builder.add_accessor(kept, test::kFloat, "VEC2");
  primitive["material"] = 0;
  const int view = builder.add_view(test::png::with_alpha(1, 1, {255}));
  builder.doc["images"] = json::array({{{"bufferView", view}, {"mimeType", "image/png"}}});
  builder.doc["textures"] = json::array({{{"source", 0}}});
  builder.doc["materials"] = json::array(
      {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}}});
  write("in.glb", builder.glb());
  const std::string notes = notes_of();
  EXPECT_TRUE(contains(notes, "coordinates of its own, TEXCOORD_3")) << notes;
  EXPECT_EQ(set_used(), 3);
  const test::GltfData file(path("out.glb"));
  const json attributes = file.doc["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(file.floats(attributes["TEXCOORD_2"]), kept);
  EXPECT_TRUE(attributes.contains("TEXCOORD_3"));
  EXPECT_EQ(file.floats(attributes["TEXCOORD_1"]), std::vector<float>(6));
  std::filesystem::remove(path("in.glb"));  // it is not valid
}

TEST_F(BakeUvSets, ASecondBakeUsesTheCoordinatesThatTheFirstOneMade) {
  write_squares({{{kFull, kFull}, {kFull}}});
  const std::string first = notes_of();
  EXPECT_TRUE(contains(first, "coordinates of its own, TEXCOORD_1 or TEXCOORD_2")) << first;
  const json made = document("out.glb");
  std::filesystem::rename(path("out.glb"), path("in.glb"));
  const std::string second = notes_of();
  EXPECT_TRUE(contains(second, "the texture uses TEXCOORD_1 or TEXCOORD_2")) << second;
  const json again = document("out.glb");
  for (std::size_t p = 0; p < 2; ++p) {
    const json &is = again["meshes"][0]["primitives"][p], &was = made["meshes"][0]["primitives"][p];
    EXPECT_EQ(is["attributes"].size(), was["attributes"].size());
    const auto set_of = [p](const json& doc) {
      const std::size_t material = doc["meshes"][0]["primitives"][p]["material"];
      return doc["materials"][material]["occlusionTexture"].value("texCoord", 0);
    };
    EXPECT_EQ(set_of(again), set_of(made));
  }
}

// Extensions may know vertices by their numbers.
TEST_F(BakeUvSets, VerticesKeepTheirNumbersAndCopiesFollow) {
  GltfBuilder builder;
  // Two squares of a fold, whose first triangle begins at the last vertex.
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1};
  const int indices = builder.add_accessor(
      std::vector<std::uint16_t>{5, 4, 0, 5, 0, 3, 0, 1, 2, 0, 2, 3}, test::kUint16, "SCALAR");
  const int mesh =
      builder.add("meshes", {{"primitives",
                              {{{"attributes", {{"POSITION", builder.add_positions(positions)}}},
                                {"indices", indices}}}}});
  builder.add("nodes", {{"mesh", mesh}});
  write("in.glb", builder.glb());
  EXPECT_TRUE(contains(notes_of(), "coordinates of its own"));
  const test::GltfData file(path("out.glb"));
  std::vector<float> kept =
      file.floats(file.doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"]);
  ASSERT_GT(kept.size(), positions.size()) << "the fold is a seam";
  kept.resize(positions.size());
  EXPECT_EQ(kept, positions);
}

TEST_F(BakeUvSets, AnOverlapThatIsAcceptedIsToldWithItsShare) {
  // A large square without the texels whose centre is on its diagonal, and a small one on two.
  const Rect two_texels = {10 / 64.0f, 20 / 64.0f, 12 / 64.0f, 21 / 64.0f};
  write_squares({{{kFull}}, {{two_texels}}});
  std::string notes = notes_of();
  EXPECT_TRUE(contains(notes, "note: the texture uses TEXCOORD_0\n")) << notes;
  EXPECT_DOUBLE_EQ(statistics()["overlap"], 2.0 / (64 * 64 - 64));
  EXPECT_TRUE(contains(notes, "note: triangles cover 100 % of the 64 x 64 texels; triangles " +
                                  std::string("overlap in 0.05 % of these\n")))
      << notes;
  const Rect one_of_many = {10.2f / 128, 20.2f / 128, 10.9f / 128, 20.7f / 128};
  write_squares({{{kFull}}, {{one_of_many}}});
  notes = notes_of("--size 128");
  EXPECT_DOUBLE_EQ(statistics()["overlap"], 1.0 / (128 * 128 - 128));
  EXPECT_TRUE(contains(notes, "; triangles overlap in less than 0.01 % of these\n")) << notes;
}

}  // namespace
}  // namespace dapple
