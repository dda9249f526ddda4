// Device memory. A scene that does not fit is refused before its BVH is built, with the needed and
// the available bytes. Buffers and pages that are used again have the right content.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "dapple/error.hpp"
#include "device/context.hpp"
#include "device/page_pool.hpp"
#include "device/upload/memory_need.hpp"
#include "support/failing_opencl.hpp"
#include "support/files/film_files.hpp"
#include "support/scenes/scene_on_device.hpp"

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
  EXPECT_TRUE(contains(error.what(), " bytes in one buffer, ")) << error.what();
  EXPECT_TRUE(contains(error.what(), " gives 100000 at most;")) << error.what();
}

TEST_F(DeviceMemory, APictureWhoseSumsAreLargerThanABufferNamesItsSizeAndTheCrop) {
  const Scene scene = make_procedural("scene:cube?divisions=1");
  RenderOptions options;
  options.width = options.height = 64;
  options.light = false;
  opencl_test::pretend_memory(0, 300'000);
  const Error error = error_of([&] { static_cast<void>(render(scene, options)); });
  EXPECT_EQ(error.kind(), ErrorKind::device);
  EXPECT_TRUE(contains(error.what(), "the sums of 64 x 64 pixels with 0 lights take "))
      << error.what();
  EXPECT_TRUE(contains(error.what(), " gives 300000 at most; render a smaller image or parts with"))
      << error.what();
  options.crop = PixelRect{0, 0, 31, 15};
  EXPECT_NO_THROW(static_cast<void>(render(scene, options)));
}

// 22 planes of 64 x 64 whole numbers of eight bytes are 720,896 bytes; normals are three more.
TEST_F(DeviceMemory, NormalsThatAreThoseOfTheFacetsNeedNoSums) {
  Scene scene = make_procedural("scene:cube?divisions=1");
  RenderOptions options;
  options.width = options.height = 64;
  options.light = false;
  options.albedo = true;
  opencl_test::pretend_memory(0, 750'000);
  EXPECT_NO_THROW(static_cast<void>(render(scene, options)));
  Mesh& mesh = scene.meshes.at(0);
  for (const V3f& position : mesh.positions) mesh.normals.push_back(position.normalized());
  const Error error = error_of([&] { static_cast<void>(render(scene, options)); });
  EXPECT_TRUE(contains(error.what(), " take 819200 bytes in one buffer, ")) << error.what();
}

TEST_F(DeviceMemory, TheMinimumNeedIsAtMostTheUploadedBytes) {
  for (const char* name : {"scene:cube?divisions=1", "scene:tree?leaves=3000",
                           "scene:cloud?leaves=3000", "scene:forest?trees=9&leaves=500"}) {
    const Scene scene = make_procedural(name);
    const scene_test::SceneOnDevice on_device(scene);
    EXPECT_LE(min_need(scene).total, on_device.uploaded.bytes) << name;
    EXPECT_GT(min_need(scene).total * 4, on_device.uploaded.bytes) << name;
  }
}

TEST(DeviceBuffers, ZerosAreZerosAlsoWhereMemoryIsUsedAgain) {
  DeviceContext& context = scene_test::device().context();
  constexpr std::size_t kCount = 1'000'003;
  const std::vector<std::uint32_t> ones(kCount, ~0u);
  for (int round = 0; round < 4; ++round) {
    const Buffer zeros = context.allocate_zeros(kCount * sizeof(std::uint32_t));
    std::vector<std::uint32_t> found(kCount, 1u);
    context.read(zeros, found.data(), kCount * sizeof(std::uint32_t));
    EXPECT_EQ(std::count(found.begin(), found.end(), 0u), static_cast<std::ptrdiff_t>(kCount));
    context.write(zeros, ones.data(), kCount * sizeof(std::uint32_t));
  }
}

TEST(PagePool, PagesHaveOneOwnerAndAreReusedAfterRelease) {
  PagePool pool;
  std::unique_ptr<Pages> first = pool.take(40'000);
  const void* const address = first->data();
  std::memset(first->data(), 255, first->bytes());
  const std::unique_ptr<Pages> second = pool.take(40'000);
  EXPECT_NE(second->data(), address);
  pool.give_back(std::move(first));
  EXPECT_NE(pool.take(80'000)->data(), address) << "of another size";
  const std::unique_ptr<Pages> again = pool.take_zeros(39'999);
  ASSERT_EQ(again->data(), address);
  const auto* bytes = static_cast<const unsigned char*>(again->data());
  EXPECT_EQ(std::count(bytes, bytes + again->bytes(), 0),
            static_cast<std::ptrdiff_t>(again->bytes()));
}

// Kept pages still hold the bytes that were written to them; new pages hold zeros.
TEST(PagePool, TheOldestReleasedPagesAreFreedFirst) {
  PagePool pool;
  const auto mark_of = [](const Pages& pages) { return *static_cast<const char*>(pages.data()); };
  std::unique_ptr<Pages> marked = pool.take(4096);
  std::memset(marked->data(), 7, marked->bytes());
  pool.give_back(std::move(marked));
  constexpr std::size_t kHalf = PagePool::kMaxKept / 2 - (std::size_t{1} << 20);
  pool.give_back(std::make_unique<Pages>(kHalf));  // no memory is used before the first write
  pool.give_back(std::make_unique<Pages>(kHalf));
  marked = pool.take(4096);
  EXPECT_EQ(mark_of(*marked), 7) << "there was room";
  pool.give_back(std::move(marked));
  for (int i = 0; i < 3; ++i) pool.give_back(std::make_unique<Pages>(kHalf));
  EXPECT_EQ(mark_of(*pool.take(4096)), 0) << "there was not";
}

// Takes more bytes than the address space has.
TEST(PagePool, AnImpossibleAllocationIsADeviceError) {
  PagePool pool;
  const Error error = error_of([&] { static_cast<void>(pool.take(std::size_t{1} << 60)); });
  EXPECT_EQ(error.kind(), ErrorKind::device);
  EXPECT_TRUE(contains(error.what(), "allocating 1152921504606846976 bytes")) << error.what();
}

}  // namespace
}  // namespace dapple
