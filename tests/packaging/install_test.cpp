// What `cmake --install --prefix` writes elsewhere than where the build was configured for: other
// builds find it with pkg-config.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using film_test::bytes_of;

class Install : public film_test::FilmFile {
 protected:
  [[nodiscard]] std::string output_of(const std::string& command) const {
    const std::string redirected = command + " >'" + path("output") + "' 2>&1";
    EXPECT_EQ(std::system(redirected.c_str()), 0) << command << "\n" << bytes_of(path("output"));
    return bytes_of(path("output"));
  }
};

TEST_F(Install, PkgConfigNamesTheFoldersThatThePrefixHas) {
  if (std::system("pkg-config --version >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "there is no pkg-config";
  const std::string prefix = path("prefix");
  static_cast<void>(
      output_of("cmake --install '" DAPPLE_BUILD_FOLDER "' --prefix '" + prefix + "'"));
  std::string found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(prefix))
    if (entry.path().filename() == "dapple.pc") found = entry.path().parent_path().string();
  ASSERT_FALSE(found.empty());
  const auto folder = [&](const char* name) {
    std::string text =
        output_of("PKG_CONFIG_PATH='" + found + "' pkg-config --variable=" + name + " dapple");
    text.erase(text.find_last_not_of('\n') + 1);
    return std::filesystem::path(text);
  };
  EXPECT_TRUE(std::filesystem::exists(folder("includedir") / "dapple" / "dapple.hpp"));
  EXPECT_TRUE(std::filesystem::exists(folder("libdir") / "libdapple.so"));
  EXPECT_TRUE(std::filesystem::exists(prefix + "/share/dapple/farm/slurm/task"));
}

}  // namespace
}  // namespace dapple
