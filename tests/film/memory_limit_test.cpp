// The limits of memory of control groups, of both versions, in a folder that stands for
// /sys/fs/cgroup: those of the process's group and of the groups above it count, and none else.
#include "film/memory_limit.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

class MemoryLimit : public film_test::FilmFile {
 protected:
  void set(const std::string& file, const std::string& limit) const {
    film_test::write_bytes(path(file), limit + "\n");
  }
  [[nodiscard]] double limit(const char* membership) const {
    return group_limit(membership, folder_);
  }
};

TEST_F(MemoryLimit, OfVersion2IsThatOfAGroupAboveWhereTheOwnHasNone) {
  set("a/memory.max", "3000000000");
  set("a/b/memory.max", "max");
  EXPECT_EQ(limit("0::/a/b\n"), 3e9);
  EXPECT_EQ(limit("0::/a\n"), 3e9);
  EXPECT_EQ(limit("0::/\n"), kNone) << "other groups have limits";
  EXPECT_EQ(limit("0::/b\n"), kNone);
  EXPECT_EQ(limit("0::/ab\n"), kNone);
}

TEST_F(MemoryLimit, OfVersion1IsInTheFolderOfItsController) {
  set("memory/x/memory.limit_in_bytes", "500");
  set("x/memory.max", "7");
  EXPECT_EQ(limit("4:memory:/x\n"), 500);
  EXPECT_EQ(limit("4:cpu,memory:/x\n"), 500);
  EXPECT_EQ(limit("4:memory,cpu:/x/y\n"), 500) << "y has no file";
  EXPECT_EQ(limit("4:cpu:/x\n"), kNone);
  EXPECT_EQ(limit("4:memory_of_others:/x\n"), kNone);
}

TEST_F(MemoryLimit, IsTheLeastOfNestedGroupsWhicheverHasIt) {
  set("memory.max", "900");
  set("a/memory.max", "300");
  set("a/b/memory.max", "600");
  set("a/c/memory.max", "100");
  EXPECT_EQ(limit("0::/a/b\n"), 300);
  EXPECT_EQ(limit("0::/a/c\n"), 100);
  EXPECT_EQ(limit("0::/\n"), 900);
  EXPECT_EQ(limit("0::/a/gone\n"), 300);
}

TEST_F(MemoryLimit, IsTheLeastOfBothVersions) {
  set("memory.max", "900");
  set("memory/x/memory.limit_in_bytes", "500");
  for (const char* lines : {"0::/\n4:memory:/x\n", "5:cpu:/x\n4:memory:/x\n0::/"})
    EXPECT_EQ(limit(lines), 500) << lines;
}

TEST_F(MemoryLimit, IsNoneWithoutFilesNumbersOrMembership) {
  EXPECT_EQ(limit("0::/a/b\n4:memory:/x\n"), kNone);
  set("memory.max", "plenty");
  EXPECT_EQ(limit("0::/\n"), kNone);
  set("memory.max", "");
  EXPECT_EQ(limit("0::/\n"), kNone);
  set("memory.max", "900");
  for (const char* text : {"", "\n", "no membership", "0:/a", ":", "\x01\xff\n\n"})
    EXPECT_EQ(limit(text), kNone) << text;
}

TEST(MachineBytes, AreMoreThanTheTestsNeed) {
  EXPECT_GT(machine_bytes(), 1e8);
  EXPECT_LT(machine_bytes(), 1e15);
}

}  // namespace
}  // namespace dapple
