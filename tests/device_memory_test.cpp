// Scenes that do not fit a device: said with needed and available bytes, before they are built.
#include <gtest/gtest.h>

#include "dapple/error.hpp"
#include "device/memory_need.hpp"
#include "failing_opencl.hpp"
#include "film_files.hpp"
#include "scene_on_device.hpp"

namespace dapple {
namespace {

using film_test::contains;
using film_test::error_of;

class DeviceMemory : public testing::Test {
 protected:
  ~DeviceMemory() override { opencl_test::pretend_memory(0, 0); }

  static Error render_error() {
    return error_of([] {
      RenderOptions options;
      options.width = options.height = 8;
      static_cast<void>(render(make_procedural("scene:cloud?leaves=20000"), options));
    });
  }
};

TEST_F(DeviceMemory, TooLittleForTheSceneIsSaidInBytesBeforeItIsBuilt) {
  opencl_test::pretend_memory(1'000'000, 0);
  const Error error = render_error();
  EXPECT_EQ(error.kind(), ErrorKind::device);
  EXPECT_TRUE(contains(error.what(), "the scene needs at least ")) << error.what();
  EXPECT_TRUE(contains(error.what(), " has 1000000;")) << error.what();
}

TEST_F(DeviceMemory, ABufferLargerThanTheDeviceGivesIsSaidToo) {
  opencl_test::pretend_memory(0, 100'000);
  const Error error = render_error();
  EXPECT_EQ(error.kind(), ErrorKind::device);
  EXPECT_TRUE(contains(error.what(), " bytes in one piece, ")) << error.what();
  EXPECT_TRUE(contains(error.what(), " gives 100000 at most;")) << error.what();
}

TEST_F(DeviceMemory, TheLeastNeedIsNeverMoreThanWhatIsUploaded) {
  for (const char* name : {"scene:cube?divisions=1", "scene:tree?leaves=3000",
                           "scene:cloud?leaves=3000", "scene:forest?trees=9&leaves=500"}) {
    const Scene scene = make_procedural(name);
    const scene_test::SceneOnDevice on_device(scene);
    EXPECT_LE(least_need(scene).total, on_device.uploaded.bytes) << name;
    EXPECT_GT(least_need(scene).total * 4, on_device.uploaded.bytes) << name;
  }
}

}  // namespace
}  // namespace dapple
