// A file that dapple bake wrote shows the picture of the one that it read. Values are the same to
// the bit: a bake adds attributes and copies vertices, and moves none.
#include <gtest/gtest.h>

#include "dapple/render.hpp"
#include "dapple/scene.hpp"
#include "support/files/compressed_gltf.hpp"
#include "support/files/draco_gltf.hpp"
#include "support/programs/bake_command.hpp"
#include "support/scenes/garden.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class BakeRoundTrip : public BakeCommand {
 protected:
  BakeRoundTrip() {
    write("in.glb", test::Garden().file.glb());
    std::ofstream(path("lights.json")) << R"({"lights": [{"type": "sun", "name": "noon",
        "direction": [0.2, -1, -0.3], "irradiance": [3, 2, 1]}]})";
  }

  /// Without shading normals, which a bake may replace.
  [[nodiscard]] Film picture(const std::string& name) const {
    SceneOptions reading;
    reading.colors = true;
    RenderOptions options;
    options.width = options.height = 32;
    options.spp = 4;
    options.estimator = Estimator::exact;
    options.normals = Normals::geometric;
    return ::dapple::render(load_gltf(path(name), reading), options).film;
  }

  /// Bakes in.glb with few rays and compares the pictures in all planes but those that begin with
  /// one of `but`.
  void expect_same_picture(const std::string& arguments, const std::vector<std::string>& but = {},
                           const std::string& output = "out.glb") {
    SCOPED_TRACE(arguments);
    const Outcome run = dapple("bake in.glb -o " + output + " --rays 8 -q " + arguments);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    const Film before = picture("in.glb"), after = picture(output);
    std::size_t compared = 0;
    for (const Plane& plane : before.planes) {
      const auto begins = [&](const std::string& part) { return plane.channel.starts_with(part); };
      if (std::any_of(but.begin(), but.end(), begins)) continue;
      ASSERT_NE(after.find(plane.channel), nullptr) << plane.channel;
      EXPECT_EQ(bits_of(after.find(plane.channel)->pixels), bits_of(plane.pixels)) << plane.channel;
      ++compared;
    }
    EXPECT_GT(compared, 10u);
    expect_bounds_of_positions(output);
  }

  /// Bakes in.glb, and what came of it once more: the second file has the size and the picture of
  /// the first.
  void expect_same_size_twice(const std::string& arguments) const {
    SCOPED_TRACE(arguments);
    const std::string options = " --rays 8 -q " + arguments;
    ASSERT_EQ(dapple("bake in.glb -o once.glb" + options).code, 0);
    ASSERT_EQ(dapple("bake once.glb -o twice.glb" + options).code, 0);
    EXPECT_NEAR(static_cast<double>(bytes_of(path("twice.glb")).size()),
                static_cast<double>(bytes_of(path("once.glb")).size()), 200);
    EXPECT_EQ(bits_of(picture("twice.glb").find("ao.R")->pixels),
              bits_of(picture("once.glb").find("ao.R")->pixels));
  }

  /// The specification demands min and max of positions, also where the vertices are copies.
  void expect_bounds_of_positions(const std::string& name) const {
    const test::GltfData file(path(name));
    for (const json& mesh : file.doc["meshes"])
      for (const json& primitive : mesh["primitives"]) {
        const json& positions = file.accessor(primitive["attributes"]["POSITION"]);
        EXPECT_TRUE(positions.contains("min") && positions.contains("max")) << positions;
      }
  }
};

TEST_F(BakeRoundTrip, TheGardenShowsWhatItShould) {
  const Film film = picture("in.glb");
  const std::vector<float>& ao = film.find("ao.R")->pixels;
  const auto [least, most] = std::minmax_element(ao.begin(), ao.end());
  EXPECT_LT(*least, 0.6f);
  EXPECT_EQ(*most, 1);
  EXPECT_EQ(load_gltf(path("in.glb")).warnings, std::vector<std::string>{});
}

TEST_F(BakeRoundTrip, OfColoursChangesTheAlbedoOnly) {
  expect_same_picture("", {"albedo", "R", "G", "B"});
}

TEST_F(BakeRoundTrip, OfOneChannelOfColoursKeepsTheirAlpha) {
  expect_same_picture("--channel COLOR_0.g --blend replace", {"albedo", "R", "G", "B"});
}

TEST_F(BakeRoundTrip, OfAttributesChangesNothing) {
  expect_same_picture("--channel _AO --passes ao,bent");
}

TEST_F(BakeRoundTrip, OfTextureCoordinatesChangesNothing) {
  expect_same_picture("--channel TEXCOORD_1.x");
}

TEST_F(BakeRoundTrip, OfNormalsChangesTheNormalsOnly) {
  expect_same_picture("--channel _AO --passes ao,bent --bent-channel NORMAL", {"N."});
}

TEST_F(BakeRoundTrip, OfATextureChangesNothing) {
  expect_same_picture("--to texture --size 64 --margin 2");
}

TEST_F(BakeRoundTrip, OfATextureBesideATextFileChangesNothing) {
  expect_same_picture("--to texture --size 64 --uv own --passes ao,bent", {}, "out.gltf");
}

TEST_F(BakeRoundTrip, OfInstancesChangesNothing) { expect_same_picture("--to instance"); }

TEST_F(BakeRoundTrip, OfUniqueMeshesChangesNothing) {
  expect_same_picture("--instances unique --channel _AO");
}

class CompressedRoundTrip : public BakeRoundTrip {
 protected:
  CompressedRoundTrip() { write("in.glb", test::compressed(test::Garden().file).glb()); }

  [[nodiscard]] static int compressed_views(const json& doc) {
    int count = 0;
    for (const json& view : doc["bufferViews"]) count += view.contains("extensions") ? 1 : 0;
    return count;
  }
};

TEST_F(CompressedRoundTrip, CompressedViewsStayCompressed) {
  const int before = compressed_views(document("in.glb"));
  EXPECT_GT(before, 10);
  for (const char* output : {"out.glb", "out.gltf"}) {
    expect_same_picture("--channel _AO --passes ao,bent", {}, output);
    EXPECT_EQ(compressed_views(document(output)), before);
  }
  expect_same_picture("--to texture --size 64 --margin 2");
  expect_same_picture("--to instance");
  expect_same_picture("--instances unique --channel _AO");
}

// Where a file's own buffer cannot be the GLB's, all of them are put into one.
TEST_F(CompressedRoundTrip, BesideATextFileTheyAreDecompressedIntoAGlb) {
  ASSERT_EQ(dapple("bake in.glb -o in.gltf --rays 8 -q --channel _AO").code, 0);
  const Outcome run = dapple("bake in.gltf -o out.glb --rays 8 -q --channel _AO");
  ASSERT_EQ(run.code, 0) << run.err;
  const json out = document("out.glb");
  EXPECT_EQ(compressed_views(out), 0);
  EXPECT_EQ(out["buffers"].size(), 1u);
  EXPECT_EQ(out["extensionsRequired"], json{"KHR_mesh_quantization"});
  EXPECT_EQ(bits_of(picture("out.glb").find("ao.R")->pixels),
            bits_of(picture("in.glb").find("ao.R")->pixels));
}

TEST_F(CompressedRoundTrip, TwiceMakesNoLargerFileThanOnce) {
  expect_same_size_twice("--channel _AO --passes ao,bent");
  expect_same_size_twice("--to texture --size 64");
}

class DracoRoundTrip : public BakeRoundTrip {
 protected:
  DracoRoundTrip() { write("in.glb", test::draco_compressed(test::Garden().file).glb()); }

  [[nodiscard]] static int compressed_primitives(const json& doc) {
    int count = 0;
    for (const json& mesh : doc["meshes"])
      for (const json& primitive : mesh["primitives"]) count += primitive.contains("extensions");
    return count;
  }
};

TEST_F(DracoRoundTrip, ShowsThePictureOfThePlainFile) {
  write("plain.glb", test::draco_decoded(test::draco_compressed(test::Garden().file)).glb());
  const Film compressed = picture("in.glb"), plain = picture("plain.glb");
  for (const Plane& plane : plain.planes)
    EXPECT_EQ(bits_of(compressed.find(plane.channel)->pixels), bits_of(plane.pixels))
        << plane.channel;
}

TEST_F(DracoRoundTrip, OfAttributesKeepsPrimitivesCompressed) {
  const int before = compressed_primitives(document("in.glb"));
  EXPECT_GE(before, 4);
  for (const char* output : {"out.glb", "out.gltf"}) {
    expect_same_picture("--channel _AO --passes ao,bent", {}, output);
    EXPECT_EQ(compressed_primitives(document(output)), before);
  }
}

TEST_F(DracoRoundTrip, OfWhatIsCompressedReplacesThatOnly) {
  expect_same_picture("", {"albedo", "R", "G", "B"});
  expect_same_picture("--channel COLOR_0.g --blend replace", {"albedo", "R", "G", "B"});
  expect_same_picture("--channel TEXCOORD_1.x");
  expect_same_picture("--channel _AO --passes ao,bent --bent-channel NORMAL", {"N."});
  EXPECT_EQ(compressed_primitives(document("out.glb")), compressed_primitives(document("in.glb")));
}

TEST_F(DracoRoundTrip, OfTexturesAndInstancesChangesNothing) {
  expect_same_picture("--to texture --size 64 --margin 2");
  expect_same_picture("--to instance");
  expect_same_picture("--instances unique --channel _AO");
}

TEST_F(DracoRoundTrip, BesideATextFileStaysCompressedInAGlb) {
  ASSERT_EQ(dapple("bake in.glb -o in.gltf --rays 8 -q --channel _AO").code, 0);
  ASSERT_EQ(dapple("bake in.gltf -o out.glb --rays 8 -q --channel _AO").code, 0);
  EXPECT_EQ(compressed_primitives(document("out.glb")), compressed_primitives(document("in.glb")));
  EXPECT_EQ(bits_of(picture("out.glb").find("ao.R")->pixels),
            bits_of(picture("in.glb").find("ao.R")->pixels));
}

TEST_F(DracoRoundTrip, TwiceMakesNoLargerFileThanOnce) {
  expect_same_size_twice("");
  expect_same_size_twice("--to texture --size 64");
}

TEST_F(BakeRoundTrip, KeepsChunksOfOtherTypes) {
  std::string glb = bytes_of(path("in.glb"));
  const std::string chunks("\x04\0\0\0ABCDdata\x08\0\0\0EFGHmore...", 28);
  glb += chunks;
  for (std::size_t i = 0; i < 4; ++i) glb[8 + i] = static_cast<char>(glb.size() >> 8 * i & 255);
  write("in.glb", glb);
  ASSERT_EQ(dapple("bake in.glb -o out.glb --rays 8 -q --channel _AO").code, 0);
  EXPECT_TRUE(bytes_of(path("out.glb")).ends_with(chunks));
  const Outcome text = dapple("bake in.glb -o out.gltf --rays 8");
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.err.find("note: 28 bytes of GLB chunks"), std::string::npos) << text.err;
  EXPECT_EQ(bits_of(picture("out.glb").find("ao.R")->pixels),
            bits_of(picture("in.glb").find("ao.R")->pixels));
  // The rules that a fixture checks know no such chunks.
  for (const char* name : {"in.glb", "out.glb"}) std::filesystem::remove(path(name));
}

TEST_F(BakeRoundTrip, TwiceMakesNoLargerFileThanOnce) {
  for (const char* arguments :
       {"", "--channel _AO --passes ao,bent", "--to texture --size 64", "--to instance"}) {
    SCOPED_TRACE(arguments);
    const std::string options = " --rays 8 -q " + std::string(arguments);
    ASSERT_EQ(dapple("bake in.glb -o once.glb" + options).code, 0);
    const Outcome again = dapple("bake once.glb -o twice.glb" + options);
    ASSERT_EQ(again.code, 0) << again.err;
    // Numbers in its JSON may have other lengths.
    EXPECT_NEAR(static_cast<double>(bytes_of(path("twice.glb")).size()),
                static_cast<double>(bytes_of(path("once.glb")).size()), 200);
    const json once = document("once.glb"), twice = document("twice.glb");
    for (const char* array : {"accessors", "bufferViews", "images", "textures", "samplers"})
      EXPECT_EQ(twice.value(array, json::array()).size(), once.value(array, json::array()).size())
          << array;
    const Film before = picture("once.glb"), after = picture("twice.glb");
    EXPECT_EQ(bits_of(after.find("ao.R")->pixels), bits_of(before.find("ao.R")->pixels));
  }
}

TEST_F(BakeRoundTrip, OfLightsChangesNothing) {
  for (const char* to : {"vertex --channel _AO", "texture --size 32", "instance"})
    expect_same_picture("--passes ao,light --lights lights.json --to " + std::string(to));
}

}  // namespace
}  // namespace dapple
