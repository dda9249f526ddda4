// The structs that host and kernels share have the same layout for both compilers: a kernel reports
// the sizes and offsets that the device's compiler uses.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "dapple/shared/bvh_node.h"
#include "dapple/shared/corner_normals.h"
#include "dapple/shared/geometry.h"
#include "dapple/shared/light_record.h"
#include "dapple/shared/pass_params.h"
#include "dapple/shared/ray.h"
#include "dapple/shared/surface_color.h"
#include "kernels/layout_members.h"
#include "support/test_kernel.hpp"

namespace dapple {
namespace {

struct Entry {
  std::string what;
  std::size_t value;
};

/// Sizes and offsets on the host, in the order in which tests/kernels/layout.cl reports them.
std::vector<Entry> host_layout() {
  std::vector<Entry> entries;
#define DAPPLE_HOST_STRUCT(Type) entries.push_back({"sizeof " #Type, sizeof(Type)});
#define DAPPLE_HOST_MEMBER(Type, member)                                        \
  entries.push_back({"offset of " #Type "::" #member, offsetof(Type, member)}); \
  entries.push_back({"sizeof " #Type "::" #member, sizeof(Type::member)});
  DAPPLE_LAYOUT(DAPPLE_HOST_STRUCT, DAPPLE_HOST_MEMBER)
#undef DAPPLE_HOST_STRUCT
#undef DAPPLE_HOST_MEMBER
  return entries;
}

TEST(Layout, TheDeviceSeesEverySharedStructAsTheHostDoes) {
  const std::vector<Entry> host = host_layout();
  const std::vector<std::uint32_t> unset(host.size() + 1, 0xdeadbeef);
  const Buffer report = kernel_test::upload(unset);
  kernel_test::run("layout", "layout", 1, {report});
  const auto device = kernel_test::download<std::uint32_t>(report, unset.size());
  for (std::size_t i = 0; i < host.size(); ++i) EXPECT_EQ(device[i], host[i].value) << host[i].what;
  EXPECT_EQ(device.back(), 0xdeadbeef) << "the kernel reports more than the host expects";
}

TEST(Layout, TheListedMembersFillTheirStructsWithoutPadding) {
  std::size_t end = 0, size = 0;
  const auto finish = [&] { EXPECT_EQ(end, size) << "members missing from layout_members.h"; };
#define DAPPLE_NEXT_STRUCT(Type) \
  finish();                      \
  end = 0;                       \
  size = sizeof(Type);
#define DAPPLE_NEXT_MEMBER(Type, member)                        \
  EXPECT_EQ(offsetof(Type, member), end) << #Type "::" #member; \
  end += sizeof(Type::member);
  DAPPLE_LAYOUT(DAPPLE_NEXT_STRUCT, DAPPLE_NEXT_MEMBER)
#undef DAPPLE_NEXT_STRUCT
#undef DAPPLE_NEXT_MEMBER
  finish();
}

}  // namespace
}  // namespace dapple
