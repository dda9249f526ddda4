// Writes the corpus's scenes and images as files for fuzzers to begin with: seeds FOLDER makes
// FOLDER/gltf and FOLDER/image.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "corpus/corpus.hpp"

namespace {

/// What fits a fuzzer's runs; bombs do not.
constexpr std::size_t kLargest = 20000;

using Bytes = std::vector<std::uint8_t>;

void write_seed(const std::filesystem::path& path, const Bytes& bytes) {
  if (bytes.size() > kLargest) return;
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

bool is_image(const std::string& name) {
  return name.ends_with(".png") || name.ends_with(".jpg") || name.ends_with(".jpeg");
}

/// The scene itself, and the images beside it.
void write_seeds(const std::filesystem::path& folder, const std::string& name,
                 const dapple::test::SceneFiles& files) {
  for (const auto& [file, bytes] : files.files) {
    if (file == files.scene) write_seed(folder / "gltf" / name, bytes);
    if (is_image(file)) write_seed(folder / "image" / (name + "_" + file), bytes);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: seeds FOLDER\n");
    return 2;
  }
  for (const auto& one : dapple::test::malformed_corpus()) write_seeds(argv[1], one.name, one.files);
  for (const auto& one : dapple::test::tricky_corpus()) write_seeds(argv[1], one.name, one.files);
  return 0;
}
