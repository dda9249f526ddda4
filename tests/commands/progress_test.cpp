// What a person sees on a terminal before rays are traced: large files and BVHs take long.
#include <gtest/gtest.h>

#include "support/programs/program_run.hpp"

namespace dapple::program_test {
namespace {

constexpr const char* kLostFile = "render no_such_file.glb -o out.exr";

class ProgressOnATerminal : public ProgramRun {
 protected:
  void SetUp() override {
    ProgramRun::SetUp();
    if (std::system("script -qec true /dev/null >/dev/null 2>&1 </dev/null") != 0)
      GTEST_SKIP() << "script (bsdutils) cannot make a terminal: is /dev/pts mounted?";
  }
  /// All that the program prints to a terminal. The program script (bsdutils) runs it in one.
  [[nodiscard]] std::string shown(const std::string& arguments) const {
    const std::string out = (logs() / "terminal").string();
    const std::string command = "cd '" + folder_.string() +
                                "' && SHELL=/bin/sh script -qec \"" DAPPLE_PROGRAM " " + arguments +
                                "\" /dev/null >'" + out + "' </dev/null";
    EXPECT_NE(std::system(command.c_str()), -1);
    return film_test::bytes_of(out);
  }
};

TEST_F(ProgressOnATerminal, SaysWhatIsReadAndBuilt) {
  const std::string text =
      shown("render scene:cube?divisions=1 -o out.exr --width 8 --height 8 --spp 1");
  const std::size_t reading = text.find("reading scene:cube?divisions=1 ..."),
                    building = text.find("building the BVH ..."), wrote = text.find("wrote ");
  EXPECT_LT(reading, building) << text;
  EXPECT_LT(building, wrote) << text;
  EXPECT_NE(wrote, std::string::npos) << text;
}

// One of 16384x8192 pixels takes seconds.
TEST_F(ProgressOnATerminal, SaysWhichImageOfASkyIsRead) {
  film_test::write_bytes(path("sky.hdr"),
                         std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") +
                             "\x5a\x78\xc8\x81\x3c\x32\x28\x80");
  ASSERT_EQ(dapple("scene cube -o cube.glb").code, 0);
  for (const char* command :
       {"render cube.glb --dome sky.hdr -o out.exr --width 8 --height 8 --spp 1",
        "bake cube.glb --passes ao,light --dome sky.hdr --rays 8 -o out.glb",
        "points cube.glb --grid 0,0,1,1,0.5 --sky sky.hdr --rays 16 -o out.csv"}) {
    const std::string text = shown(command);
    EXPECT_TRUE(film_test::contains(text, "reading sky.hdr ...")) << text;
    EXPECT_TRUE(film_test::contains(text, "building the BVH ...")) << text;
  }
}

TEST_F(ProgressOnATerminal, IsErasedBeforeAnError) {
  const std::string text = shown(kLostFile);
  EXPECT_NE(text.find("\r\033[Kdapple: no_such_file.glb: no such file"), std::string::npos) << text;
}

TEST_F(ProgressOnATerminal, IsNotForFilesNorIfQuiet) {
  EXPECT_EQ(dapple(kLostFile).err.find("reading"), std::string::npos);
  const std::string quiet = shown(kLostFile + std::string(" -q"));
  EXPECT_EQ(quiet.find("reading"), std::string::npos) << quiet;
  EXPECT_NE(quiet.find("no such file"), std::string::npos) << quiet;
}

}  // namespace
}  // namespace dapple::program_test
