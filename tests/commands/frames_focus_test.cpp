// Where a lens focuses in a sequence whose camera brings no focus distance.
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/files/gltf_builder.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace program_test;

class FramesFocus : public ProgramRun {
 protected:
  /// Writes rise.glb: the triangle rises towards a camera that looks down on it.
  void write_rise() const {
    test::GltfBuilder b = test::one_triangle();
    const int times = b.add_accessor(std::vector<float>{0, 1}, test::kFloat, "SCALAR");
    const int values = b.add_positions({0, 0, 0, 0, 1, 0});
    b.add("animations",
          {{"samplers", {{{"input", times}, {"output", values}}}},
           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    b.add("nodes", {{"translation", {0.3, 4, 0}},
                    {"rotation", {-0.70710678, 0, 0, 0.70710678}},
                    {"camera", 0}});
    const auto bytes = b.glb();
    std::ofstream(path("rise.glb"), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  [[nodiscard]] float focus_distance(const char* name) const {
    const Imf::InputFile file(path(name).c_str());
    const auto& header = file.header();
    return std::stof(header.typedAttribute<Imf::StringAttribute>("dapple:focus_distance").value());
  }
};

TEST_F(FramesFocus, ASequenceKeepsTheFocusOfItsFirstFrame) {
  write_rise();
  ASSERT_EQ(dapple("render rise.glb --width 8 --height 8 --spp 2 --frames 0-1 --fps 1 --aperture "
                   "0.1 --passes ao -o a.#.exr")
                .code,
            0);
  EXPECT_GT(focus_distance("a.0.exr"), 1);
  EXPECT_EQ(focus_distance("a.0.exr"), focus_distance("a.1.exr"));
}

}  // namespace
}  // namespace dapple
