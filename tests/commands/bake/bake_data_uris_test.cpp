// What dapple bake reads of data: URIs: base64 with the line breaks and blanks that encoders write,
// and its name in any case. The reader's triangles are those of a plain data: URI.
#include <gtest/gtest.h>

#include "dapple/scene.hpp"
#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace program_test;

/// (0,0,0) (1,0,0) (0,1,0) as floats, with four zero bytes behind them.
const std::string kTriangle = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAA==";

/// `text` with `between` after each 20 characters, and at its end.
std::string broken(const std::string& text, const std::string& between) {
  std::string lines;
  for (std::size_t i = 0; i < text.size(); i += 20) lines += text.substr(i, 20) + between;
  return lines;
}

class BakeDataUris : public BakeCommand {
 protected:
  /// in.gltf is a triangle whose buffer is this data: URI.
  void write_buffer(const std::string& uri) const {
    json doc = test::one_triangle().doc;
    doc["buffers"] = {{{"byteLength", 40}, {"uri", uri}}};
    std::ofstream(path("in.gltf")) << doc.dump();
  }
  void TearDown() override {
    std::filesystem::remove(path("in.gltf"));  // test::GltfData reads no data: URIs
    BakeCommand::TearDown();
  }
};

TEST_F(BakeDataUris, OfBase64MayHaveLineBreaksAndBlanksAndItsNameInCapitals) {
  const std::vector<test::Triangle> triangles = test::world_triangles(test::one_triangle().load());
  ASSERT_EQ(triangles.size(), 1u);
  const std::string type = "data:application/octet-stream";
  for (const std::string& uri :
       {type + ";base64," + kTriangle, type + ";BASE64," + kTriangle, "data:;Base64," + kTriangle,
        type + ";base64," + broken(kTriangle, "\n"), type + ";base64," + broken(kTriangle, "\r\n"),
        type + ";base64," + broken(kTriangle, " \t"), type + ";base64, " + kTriangle}) {
    SCOPED_TRACE(uri);
    write_buffer(uri);
    EXPECT_TRUE(test::world_triangles(load_gltf(path("in.gltf"))) == triangles);
    const Outcome run = dapple("bake in.gltf -o out.glb --rays 8 -q");
    EXPECT_EQ(run.code, 0) << run.err;
  }
}

}  // namespace
}  // namespace dapple
