// Reads any bytes as an EXR image and as a dome's: each channel has the pixels that the header
// says, and a dome's are finite and not negative; or an Error of kind input names the file.
#include <cmath>
#include <cstdlib>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "files/exr_reader.hpp"
#include "input_file.hpp"

namespace {

using namespace dapple;

/// Larger images are opened and not read: files this small cannot have them, and what libFuzzer
/// would find is the memory that they claim, and the time to fill it.
constexpr std::size_t kMaxValues = std::size_t{1} << 14;

void require(bool condition) {
  if (!condition) std::abort();
}

/// Whether it is small enough to be read as a dome, too.
bool read_image(const std::string& path) {
  ExrFile file(path);
  const std::size_t pixels = std::size_t{file.width()} * file.height();
  if (pixels * file.channels().size() > kMaxValues) return false;
  const ExrImage image = file.image();
  require(image.width == file.width() && image.height == file.height());
  require(image.channels.size() == file.channels().size());
  for (const auto& [name, values] : image.channels) require(values.size() == pixels);
  return true;
}

void read_dome(const std::string& path) {
  const auto dome = load_environment(path);
  require(dome->radiance.size() == std::size_t{dome->width} * dome->height);
  for (const V3f& radiance : dome->radiance)
    for (int i = 0; i < 3; ++i) require(std::isfinite(radiance[i]) && radiance[i] >= 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const fuzz::InputFile file("image.exr");
  const std::string& path = file.fill(bytes, size);
  try {
    if (read_image(path)) read_dome(path);
  } catch (const Error& error) {
    require(error.kind() == ErrorKind::input);
    require(std::string(error.what()).find(path + ": ") == 0);
  }
  return 0;
}
