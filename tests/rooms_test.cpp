// The rooms (folders) of the source tree: which room may include which other room, and which
// folders may include a third-party library. README and CONTRIBUTING list the rooms in this order.
// In: every source file; out: one failure for each include that breaks a rule, with file and line.
// docs/design.md shows the same order.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace dapple {
namespace {

namespace fs = std::filesystem;

/// Rooms in the order of data flow: a room may include itself and earlier rooms.
const std::vector<std::string> kHostRooms{"files",  "scene",    "bvh",     "device", "camera",
                                          "film",   "sampling", "passes",  "render", "bake",
                                          "points", "compare",  "commands"};
const std::vector<std::string> kKernelRooms{"vectors", "sampling",  "geometry", "intersect",
                                            "opacity", "occlusion", "film",     "camera",
                                            "scalar",  "shading",   "lights"};

/// A library's headers, and the folders and files that may include them.
struct Library {
  std::string name;
  std::regex header;
  std::vector<std::string> allowed;  ///< path prefixes
};

const std::vector<Library> kLibraries{
    {"OpenCL", std::regex("CL/.*"), {"host/device/"}},
    {"tinygltf", std::regex("tiny_gltf\\.h"), {"host/scene/gltf/"}},
    {"OpenEXR",
     std::regex("(OpenEXR/)?Imf[A-Z].*"),
     {"host/files/exr_", "host/film/exr/exr_writer"}},
    {"oneTBB",
     std::regex("tbb/.*"),
     {"host/files/", "host/scene/", "host/bvh/", "host/device/", "host/film/", "host/sampling/",
      "host/render/", "host/bake/", "host/points/"}},
    {"stb", std::regex("(stb/)?stb_.*"), {"host/scene/images/", "host/film/preview/png."}},
    {"libwebp", std::regex("webp/.*"), {"host/scene/images/webp."}},
    {"meshoptimizer",
     std::regex("meshoptimizer\\.h"),
     {"host/scene/gltf/document/compressed_views."}},
    {"Draco", std::regex("draco/.*"), {"host/scene/gltf/document/draco_mesh."}},
    {"xxHash and zstd", std::regex("xxhash\\.h|zstd\\.h"), {"host/files/"}},
    {"CLI11", std::regex("CLI/.*"), {"host/commands/", "host/main.cpp"}},
};

struct Include {
  std::string file;  ///< path below the source folder
  int line;          ///< counted from 1
  std::string name;  ///< the text between the quotes or brackets
  [[nodiscard]] std::string position() const { return file + ":" + std::to_string(line); }
};

std::vector<Include> includes_of(const fs::path& path, const std::string& file) {
  static const std::regex directive("\\s*#\\s*include\\s*[\"<]([^\">]+)[\">].*");
  std::vector<Include> found;
  std::ifstream stream(path);
  std::string text;
  for (int line = 1; std::getline(stream, text); ++line) {
    std::smatch match;
    if (std::regex_match(text, match, directive)) found.push_back({file, line, match[1]});
  }
  return found;
}

/// Every include below `folder` of the source tree.
std::vector<Include> includes_below(const std::string& folder) {
  static const std::set<std::string> sources{".cpp", ".hpp", ".h", ".cl", ".clh"};
  const fs::path root(DAPPLE_SOURCE_FOLDER);
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    if (!sources.contains(entry.path().extension().string())) continue;
    const std::vector<Include> more =
        includes_of(entry.path(), fs::relative(entry.path(), root).generic_string());
    found.insert(found.end(), more.begin(), more.end());
  }
  return found;
}

/// The n-th folder of a path, counted from 0: "b" of "a/b/c.hpp" for n = 1. Empty if there is none.
std::string folder_at(const std::string& path, int n) {
  std::size_t begin = 0, end = path.find('/');
  for (; n > 0 && end != std::string::npos; --n) {
    begin = end + 1;
    end = path.find('/', begin);
  }
  return end == std::string::npos || n > 0 ? "" : path.substr(begin, end - begin);
}

/// Position in `rooms`, or -1.
std::ptrdiff_t rank_of(const std::vector<std::string>& rooms, const std::string& room) {
  const auto found = std::find(rooms.begin(), rooms.end(), room);
  return found == rooms.end() ? -1 : found - rooms.begin();
}

/// Fails for each include of a later room, and for each room that `rooms` does not list.
void expect_order(const std::string& tree, const std::vector<std::string>& rooms) {
  std::set<std::string> seen;
  for (const Include& include : includes_below(tree)) {
    const std::string room = folder_at(include.file, 1);
    if (room.empty()) continue;  // main.cpp, queue_kernels.cl
    seen.insert(room);
    const std::ptrdiff_t rank = rank_of(rooms, room);
    EXPECT_GE(rank, 0) << include.position() << ": the room " << room
                       << " is not in rooms_test.cpp";
    EXPECT_LE(rank_of(rooms, folder_at(include.name, 0)), rank)
        << include.position() << ": " << room << " includes \"" << include.name
        << "\" of a later room";
  }
  EXPECT_EQ(seen.size(), rooms.size()) << tree << ": a room is gone; take it out of rooms_test.cpp";
}

TEST(Rooms, HostFoldersIncludeOnlyEarlierRooms) { expect_order("host", kHostRooms); }

TEST(Rooms, KernelFoldersIncludeOnlyEarlierRooms) { expect_order("kernels", kKernelRooms); }

TEST(Rooms, LibrariesAreIncludedInTheirRoomsOnly) {
  std::set<std::string> used;
  std::vector<Include> includes = includes_below("host");
  const std::vector<Include> interface = includes_below("include");
  includes.insert(includes.end(), interface.begin(), interface.end());
  for (const Include& include : includes) {
    for (const Library& library : kLibraries) {
      if (!std::regex_match(include.name, library.header)) continue;
      used.insert(library.name);
      EXPECT_TRUE(std::ranges::any_of(
          library.allowed,
          [&](const std::string& beginning) { return include.file.starts_with(beginning); }))
          << include.position() << ": " << library.name << " is included outside of its rooms";
    }
  }
  EXPECT_EQ(used.size(), kLibraries.size()) << "a rule matches no include at all";
}

/// The Python package uses the library as other programs do, and the names of light layers.
TEST(Rooms, PythonIncludesPublicHeadersAndLayerNames) {
  const std::vector<Include> includes = includes_below("python/src");
  EXPECT_GT(includes.size(), 20u);
  for (const Include& include : includes) {
    const std::string folder = folder_at(include.name, 0);
    EXPECT_TRUE(folder.empty() || folder == "dapple" || folder == "nanobind" ||
                include.name == "film/layers.hpp")
        << include.position() << ": the package includes \"" << include.name << "\"";
  }
}

TEST(Rooms, PublicHeadersIncludeNoPrivateOnes) {
  const std::vector<Include> includes = includes_below("include");
  EXPECT_GT(includes.size(), 20u);
  for (const Include& include : includes) {
    const std::string folder = folder_at(include.name, 0);
    EXPECT_TRUE(folder.empty() || folder == "dapple" || folder == "Imath")
        << include.position() << ": a public header includes \"" << include.name << "\"";
  }
}

}  // namespace
}  // namespace dapple
