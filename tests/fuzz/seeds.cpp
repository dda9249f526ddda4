// Writes the corpus's scenes as files for a fuzzer to begin with: seeds FOLDER.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "corpus/corpus.hpp"

namespace {

/// What fits a fuzzer's runs; bombs do not.
constexpr std::size_t kLargest = 20000;

void write_seed(const std::filesystem::path& folder, const std::string& name,
                const dapple::test::SceneFiles& files) {
  const auto scene = files.files.find(files.scene);
  if (scene == files.files.end() || scene->second.size() > kLargest) return;
  std::ofstream(folder / name, std::ios::binary)
      .write(reinterpret_cast<const char*>(scene->second.data()),
             static_cast<std::streamsize>(scene->second.size()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: seeds FOLDER\n");
    return 2;
  }
  std::filesystem::create_directories(argv[1]);
  for (const auto& one : dapple::test::malformed_corpus()) write_seed(argv[1], one.name, one.files);
  for (const auto& one : dapple::test::tricky_corpus()) write_seed(argv[1], one.name, one.files);
  return 0;
}
