// Drivers that cannot compile the kernels are refused by version, in one line that says what to
// install, before anything is compiled. The versions that are tested are not refused.
#include "device/refused_drivers.hpp"

#include <gtest/gtest.h>

#include "dapple/device.hpp"
#include "dapple/error.hpp"
#include "device/platform_names.hpp"
#include "support/failing_opencl.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using film_test::contains;
using film_test::error_of;

TEST(RefusedDrivers, OnlyPocl30IsRefusedHoweverItsVersionIsWritten) {
  for (const std::string version : {"3.0", "3.0-rc2", "3.0+debian", "3.0 RelWithDebInfo"}) {
    const std::string refusal = driver_refusal(kPoclPlatform, version);
    EXPECT_TRUE(refusal.starts_with("PoCL " + version + " is not used: ")) << refusal;
    EXPECT_TRUE(contains(refusal, "install PoCL 3.1 or later")) << refusal;
    EXPECT_FALSE(contains(refusal, "\n"));
    EXPECT_EQ(driver_refusal("Intel(R) OpenCL", version), "");
  }
  for (const char* version :
       {"3.1", "3.1+debian", "3.01", "3", "", "5.0+debian", "6.0", "13.0", "2.3.0", "30"})
    EXPECT_EQ(driver_refusal(kPoclPlatform, version), "") << version;
}

class RefusedDriver : public testing::Test {
 protected:
  void SetUp() override {
    for (const DeviceInfo& device : list_devices())
      if (device.platform != kPoclPlatform) GTEST_SKIP() << "another driver would be used";
    opencl_test::pretend_driver_version("3.0-rc2");
  }
  ~RefusedDriver() override { opencl_test::pretend_driver_version(""); }
};

TEST_F(RefusedDriver, IsNeitherListedNorOpenedAndTheReasonIsTheError) {
  const std::function<void()> ways[] = {[] { static_cast<void>(list_devices()); },
                                        [] { const Device device; },
                                        [] { const Device device("nosuch"); }};
  for (const auto& way : ways) {
    const Error error = error_of(way);
    EXPECT_EQ(error.kind(), ErrorKind::device);
    EXPECT_TRUE(contains(error.what(), "PoCL 3.0-rc2 is not used: ")) << error.what();
  }
}

}  // namespace
}  // namespace dapple
