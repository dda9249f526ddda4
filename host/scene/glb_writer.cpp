// Writes a scene as one GLB file (glTF 2.0 Specification, section 4), beside its path and
// then renamed over it, so that nobody meets half a file. The same scene gives the same bytes.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/glb_layout.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kGlbVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

// GLB is little-endian whatever the machine.
void write_word(std::ostream& out, std::size_t word) {
  std::array<char, 4> bytes{};
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<char>((word >> (8 * i)) & 0xff);
  out.write(bytes.data(), bytes.size());
}

void write_chunks(std::ostream& out, const GlbLayout& layout, std::size_t total) {
  write_word(out, kGlbMagic);
  write_word(out, kGlbVersion);
  write_word(out, total);
  write_word(out, layout.json.size());
  write_word(out, kJsonChunk);
  out.write(layout.json.data(), static_cast<std::streamsize>(layout.json.size()));
  if (layout.byte_count == 0) return;
  write_word(out, layout.byte_count);
  write_word(out, kBinChunk);
  for (const auto& piece : layout.pieces) {
    out.write(reinterpret_cast<const char*>(piece.data()),
              static_cast<std::streamsize>(piece.size()));
  }
}

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::failed, fmt::format("{}: {}", path, what));
}

std::string errno_text() { return std::strerror(errno); }

// The name under which the file grows; gone again unless it was renamed.
class FileBeside {
 public:
  explicit FileBeside(const std::string& path)
      : path_(path), beside_(fmt::format("{}.{}.part", path, getpid())) {
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
      fail(path, "is there already and is not a regular file");
    }
    file_.open(beside_, std::ios::binary | std::ios::trunc);
    if (!file_) fail(path, "cannot be written: " + errno_text());
  }
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;
  ~FileBeside() {
    if (renamed_) return;
    std::error_code ignored;
    std::filesystem::remove(beside_, ignored);
  }

  std::ostream& stream() { return file_; }

  void finish() {
    file_.close();  // the last bytes meet a full disk here
    if (!file_) fail(path_, "cannot be written: " + errno_text());
    std::error_code error;
    std::filesystem::rename(beside_, path_, error);
    if (error) fail(path_, "cannot be replaced: " + error.message());
    renamed_ = true;
  }

 private:
  std::string path_;
  std::string beside_;
  std::ofstream file_;
  bool renamed_ = false;
};

}  // namespace

void write_glb(const Scene& scene, const std::string& path) {
  GlbLayout layout = lay_out_glb(scene);
  layout.json.resize((layout.json.size() + 3) / 4 * 4, ' ');
  const std::size_t total = kHeaderBytes + kChunkHeaderBytes + layout.json.size() +
                            (layout.byte_count > 0 ? kChunkHeaderBytes + layout.byte_count : 0);
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    fail(path, fmt::format("would have {} bytes; a GLB file has room for 4294967295", total));
  }
  FileBeside file(path);
  write_chunks(file.stream(), layout, total);
  file.finish();
}

}  // namespace dapple
