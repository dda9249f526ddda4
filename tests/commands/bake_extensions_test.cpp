// dapple bake of files with extensions that say again what a bake changes: compressed copies of
// attributes, other materials of a primitive, images of other formats.
#include <gtest/gtest.h>

#include "dapple/scene.hpp"
#include "support/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

constexpr const char* kDraco = "KHR_draco_mesh_compression";

class BakeExtensions : public BakeCommand {
 protected:
  [[nodiscard]] json baked(const std::string& arguments) const {
    const Outcome run = dapple("bake in.glb -o out.glb " + arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return run.code == 0 ? document("out.glb") : json();
  }
};

GltfBuilder compressed_triangle() {
  GltfBuilder builder = rich_triangle();
  builder.doc["meshes"][0]["primitives"][0]["extensions"][kDraco] = {
      {"bufferView", builder.add_view(test::Bytes(100))}, {"attributes", {{"POSITION", 0}}}};
  builder.doc["extensionsUsed"].push_back(kDraco);
  return builder;
}

TEST_F(BakeExtensions, ACompressedCopyOfWhatChangesIsLeftOut) {
  write("in.glb", compressed_triangle().glb());
  for (const char* to : {"vertex", "texture --size 16"}) {
    const json after = baked(std::string("--to ") + to);
    EXPECT_FALSE(after["meshes"][0]["primitives"][0].contains("extensions")) << to;
    EXPECT_EQ(after["extensionsUsed"], json{"ACME_wind"}) << to;
  }
  EXPECT_EQ(baked("--to instance")["meshes"], document("in.glb")["meshes"]);
}

TEST_F(BakeExtensions, CompressedMeshesThatAreNotBakedStayCompressed) {
  GltfBuilder builder = compressed_triangle();
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);  // no node shows it
  write("in.glb", builder.glb());
  const json after = baked("");
  EXPECT_FALSE(after["meshes"][0]["primitives"][0].contains("extensions"));
  EXPECT_EQ(after["meshes"][1], builder.doc["meshes"][1]);
  EXPECT_EQ(after["extensionsUsed"], builder.doc["extensionsUsed"]);
}

TEST_F(BakeExtensions, EmbeddedImagesHaveTheirOwnMediaType) {
  GltfBuilder builder = rich_triangle();
  builder.doc["images"] = {{{"uri", "leaf.webp"}}};
  write("in.glb", builder.glb());
  write_bytes(path("leaf.webp"), "RIFF1234WEBPVP8L");
  EXPECT_EQ(baked("")["images"][0]["mimeType"], "image/webp");
}

}  // namespace
}  // namespace dapple
