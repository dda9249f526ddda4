// Two OpenCL drivers beside one another: PoCL and a fake one, whose device is listed first and
// cannot be opened. What `dapple devices --check` says of each, and which of them renders.
#include <gtest/gtest.h>

#include "dapple/device.hpp"
#include "device/platform_names.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using program_test::Outcome;

namespace fs = std::filesystem;

class TwoDrivers : public program_test::ProgramRun {
 protected:
  void SetUp() override {
    for (const DeviceInfo& device : list_devices())
      if (device.platform == kPoclPlatform) pocl_ = device.name;
    const char* vendors = std::getenv("OCL_ICD_VENDORS");
    const fs::path installed = fs::path(vendors ? vendors : "/etc/OpenCL/vendors") / "pocl.icd";
    if (pocl_.empty() || !fs::exists(installed)) GTEST_SKIP() << "no PoCL in " << installed;
    fs::create_directory(path("vendors"));
    fs::copy_file(installed, path("vendors/pocl.icd"));
    write_bytes(path("vendors/fake.icd"), DAPPLE_FAKE_DRIVER "\n");
  }

  /// Variables for a run with both drivers, the fake one with these names.
  [[nodiscard]] std::string with_fake(const std::string& device,
                                      const std::string& platform = "Fake",
                                      const std::string& version = "1") const {
    return "OCL_ICD_VENDORS='" + path("vendors") + "' FAKE_OPENCL_DEVICE='" + device +
           "' FAKE_OPENCL_PLATFORM='" + platform + "' FAKE_OPENCL_VERSION='" + version + "'";
  }

  /// What `dapple devices` prints of a device: from its name up to a line that is not indented.
  static std::string part_of(const std::string& text, const std::string& name) {
    const std::string lines = "\n" + text;
    const std::size_t begin = lines.find("\n" + name + "\n");
    if (begin == std::string::npos) return {};
    std::size_t end = begin + 1 + name.size();
    while (lines.compare(end, 3, "\n  ") == 0) end = lines.find('\n', end + 1);
    return lines.substr(begin + 1, end - begin);
  }

  std::string pocl_;  ///< the name of PoCL's device
};

TEST_F(TwoDrivers, EachDeviceIsCheckedAlsoIfItsNameIsPartOfAnothers) {
  const std::string longer = "GPU beside " + pocl_;
  const Outcome run = dapple("devices --check", with_fake(longer));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(run.out.starts_with(longer + "\n")) << run.out;
  EXPECT_TRUE(contains(part_of(run.out, longer), "  cannot be used: opening " + longer)) << run.out;
  EXPECT_TRUE(contains(part_of(run.out, pocl_), "  runs every kernel; ")) << run.out;
  const Outcome picture = render("--device '" + pocl_ + "'", with_fake(longer));
  EXPECT_EQ(picture.code, 0) << picture.err;
  EXPECT_TRUE(contains(picture.out, " on " + pocl_)) << picture.out;
}

TEST_F(TwoDrivers, ADeviceThatCannotBeUsedIsAnErrorIfItIsChosenOrThereIsNoOther) {
  const std::string refusal = "opening fake failed (clCreateContext: CL_DEVICE_NOT_AVAILABLE)";
  expect_failure(render("--device fake", with_fake("fake")), 4, refusal);
  fs::remove_all(path("vendors"));
  write_bytes(path("vendors/fake.icd"), DAPPLE_FAKE_DRIVER "\n");
  const Outcome run = dapple("devices --check", with_fake("fake"));
  EXPECT_EQ(run.code, 4) << run.out;
  EXPECT_TRUE(contains(run.err, "no OpenCL device can run every kernel")) << run.err;
  EXPECT_TRUE(contains(run.out, "  cannot be used: " + refusal)) << run.out;
}

TEST_F(TwoDrivers, ARefusedOneIsNamedAndTheOtherIsUsed) {
  const std::string with_old = with_fake("old", kPoclPlatform, "3.0-rc2");
  const Outcome run = dapple("devices", with_old);
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "\nPoCL 3.0-rc2 is not used: ")) << run.out;
  EXPECT_NE(part_of(run.out, pocl_), "") << run.out;
  EXPECT_EQ(part_of(run.out, "old"), "");
  const Outcome picture = render("", with_old);
  EXPECT_EQ(picture.code, 0) << picture.err;
  const Outcome chosen = render("--device old", with_old);
  expect_failure(chosen, 4, "no OpenCL device matches --device 'old'; there are: '" + pocl_);
  EXPECT_TRUE(contains(chosen.err, "; PoCL 3.0-rc2 is not used: ")) << chosen.err;
}

TEST_F(TwoDrivers, OneWithAnOlderLanguageIsNotTaken) {
  const std::string with_old = with_fake("old") + " FAKE_OPENCL_C='OpenCL C 1.1 Fake'";
  const Outcome picture = render("", with_old);
  EXPECT_EQ(picture.code, 0) << picture.err;
  const std::string refusal = "old is not used: its driver compiles OpenCL C 1.1";
  EXPECT_TRUE(contains(dapple("devices", with_old).out, "\n" + refusal));
  EXPECT_TRUE(contains(render("--device old", with_old).err, "; " + refusal));
}

TEST_F(TwoDrivers, AGpuWithItsOwnMemoryComesBeforeALargerOneWithTheHosts) {
  const Outcome run =
      dapple("devices", with_fake("integrated") + " FAKE_OPENCL_SECOND_DEVICE=discrete");
  EXPECT_EQ(run.code, 0) << run.err;
  const std::size_t discrete = run.out.find("discrete\n"),
                    integrated = run.out.find("integrated\n"),
                    cpu = run.out.find("\n" + pocl_ + "\n");
  EXPECT_EQ(discrete, 0u) << run.out;
  EXPECT_LT(discrete, integrated) << run.out;
  EXPECT_LT(integrated, cpu) << run.out;
  EXPECT_NE(cpu, std::string::npos) << run.out;
}

TEST_F(TwoDrivers, WhereADriverDoesNotTellWhoseMemoryItIsTheLargerGpuComesFirst) {
  const Outcome run =
      dapple("devices",
             with_fake("large") + " FAKE_OPENCL_SECOND_DEVICE=small FAKE_OPENCL_MEMORY=unknown");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_LT(run.out.find("large\n"), run.out.find("small\n")) << run.out;
  EXPECT_NE(run.out.find("small\n"), std::string::npos) << run.out;
}

// The loader has the platform of a library once or twice, as it likes.
TEST_F(TwoDrivers, TheSameDriverTwiceIsNoErrorAndRefusedOnce) {
  fs::copy_file(path("vendors/pocl.icd"), path("vendors/pocl_again.icd"));
  fs::copy_file(path("vendors/fake.icd"), path("vendors/fake_again.icd"));
  const Outcome run = dapple("devices --check", with_fake("old", kPoclPlatform, "3.0"));
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_FALSE(contains(run.out, "cannot be used")) << run.out;
  EXPECT_TRUE(contains(part_of(run.out, pocl_), "  runs every kernel; ")) << run.out;
  const std::string refusal = "PoCL 3.0 is not used: ";
  const std::size_t first = run.out.find(refusal);
  ASSERT_NE(first, std::string::npos) << run.out;
  EXPECT_EQ(run.out.find(refusal, first + 1), std::string::npos) << run.out;
}

}  // namespace
}  // namespace dapple
