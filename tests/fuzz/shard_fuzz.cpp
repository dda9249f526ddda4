// Merges parts that dapple did not write: sealed files with a right checksum around any contents,
// and files near to parts. They are refused by name, or make a picture of the size that they say.
#include <fuzzer/FuzzedDataProvider.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "dapple/shared/ray.h"
#include "files/compression.hpp"
#include "files/sealed_file.hpp"
#include "render/partial/checkpoint.hpp"
#include "render/partial/merge.hpp"

namespace {

using namespace dapple;

/// One of eight times, and not where no bytes are left: parts are merged only if nearly all of what
/// they say is sound.
bool is_odd(FuzzedDataProvider& data) { return data.ConsumeIntegralInRange(0, 7) == 7; }

std::string path(int number) {
  return std::filesystem::temp_directory_path() /
         ("dapple_part_" + std::to_string(getpid()) + "_" + std::to_string(number));
}

void require(bool condition) {
  if (!condition) std::abort();
}

/// Any text as the header, and any sections.
void write_any(FuzzedDataProvider& data, const std::string& file) {
  const std::string about = data.ConsumeRandomLengthString();
  std::vector<std::vector<std::byte>> packed;
  for (int i = data.ConsumeIntegralInRange(0, 5); i > 0; --i)
    packed.push_back(compress(data.ConsumeBytes<std::byte>(40)));
  std::vector<Section> sections{as_section(about)};
  for (const auto& bytes : packed) sections.emplace_back(bytes);
  write_sealed_file(file, {"checkpoint", 5}, sections, Durable::no);
}

PictureRecord any_picture(FuzzedDataProvider& data) {
  PictureRecord picture;
  picture.width = data.ConsumeIntegralInRange(1, 6);
  picture.height = data.ConsumeIntegralInRange(1, 6);
  const auto corner = [&] { return data.ConsumeIntegralInRange(-1, 6); };
  picture.crop = {0, 0, picture.width - 1, picture.height - 1};
  if (is_odd(data)) picture.crop = {corner(), corner(), corner(), corner()};
  RenderOptions& options = picture.options;
  options.camera_splitting = data.ConsumeIntegralInRange(1, 4);
  options.ao = data.ConsumeBool();
  options.albedo = data.ConsumeBool();
  options.back = data.ConsumeBool();
  options.motion = data.ConsumeBool();
  options.cryptomattes = {data.ConsumeBool(), data.ConsumeBool()};
  picture.has_normals = data.ConsumeBool();
  for (int i = data.ConsumeIntegralInRange(0, 2); i > 0; --i) {
    Light light;
    light.name = data.ConsumeRandomLengthString(4);
    light.group = data.ConsumeRandomLengthString(2);
    light.kind = static_cast<LightKind>(data.ConsumeIntegralInRange(0, 9));
    picture.lights.push_back(light);
    picture.scales.lights.push_back(0x1p26f);
  }
  for (int i = data.ConsumeIntegralInRange(0, 2); i > 0; --i) {
    picture.names.objects.push_back(std::to_string(i));
    picture.names.materials.push_back(std::to_string(i));
  }
  picture.metadata.samples = data.ConsumeIntegralInRange(1, 8);
  picture.metadata.settings = {{"ambient", "0"}};
  return picture;
}

/// A file that is what its header says, unless the data say otherwise.
void write_likely(FuzzedDataProvider& data, const std::string& file) {
  Checkpoint part;
  part.picture = any_picture(data);
  TraceState& state = part.state;
  state.slice_samples = data.ConsumeIntegralInRange<std::uint32_t>(0, 64);
  const std::uint32_t splitting = is_odd(data) ? 1 : splitting_factor(part.picture.options);
  state.first_sample = splitting * data.ConsumeIntegralInRange<std::uint32_t>(0, 4);
  const PixelRect& crop = part.picture.crop;
  const bool sound = crop.x0 >= 0 && crop.y0 >= 0 && crop.x0 <= crop.x1 && crop.y0 <= crop.y1;
  const std::size_t pixels = sound ? part.picture.layout().pixels : 1;
  const std::size_t planes = sound ? part.picture.layout().plane_count : 1;
  state.sums.resize(pixels * planes + (is_odd(data) ? 1 : 0));
  for (std::int64_t& sum : state.sums)
    if (data.remaining_bytes() > 0) sum = data.ConsumeIntegral<std::int64_t>();
  state.samples.assign(pixels, splitting * data.ConsumeIntegralInRange<std::uint32_t>(1, 4));
  if (!is_odd(data)) {
    for (std::size_t p = 0; p < pixels; ++p) state.sums[p] &= state.samples[p];  // that hit
  }
  if (part.picture.options.cryptomattes.any()) {
    state.mattes.assign(pixels, 0);
    if (data.ConsumeBool()) state.mattes[0] = data.ConsumeIntegral<std::uint32_t>();
  }
  if (part.picture.options.motion) state.motion = MotionSums(pixels);
  for (int i = is_odd(data) ? data.ConsumeIntegralInRange(1, 2) : 0; i > 0; --i) {
    const auto corner = [&] { return data.ConsumeIntegralInRange(-1, 6); };
    const auto ray = [&] { return data.ConsumeIntegralInRange<std::uint32_t>(0, 9); };
    part.pieces.push_back({{corner(), corner(), corner(), corner()}, {ray(), ray()}});
  }
  write_checkpoint(file, part, state);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  // Handing out the work on a few pixels would take longer than the work.
  static const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  FuzzedDataProvider data(bytes, size);
  std::vector<std::string> paths;
  for (int i = data.ConsumeIntegralInRange(1, 2); i > 0; --i) {
    paths.push_back(path(i));
    if (is_odd(data))
      write_any(data, paths.back());
    else
      write_likely(data, paths.back());
  }
  try {
    const Merge merge = merge_parts(paths, path(0));
    const PixelRect& window = merge.result.film.data_window;
    for (const Plane& plane : merge.result.film.planes)
      require(plane.pixels.size() == static_cast<std::size_t>(window.width() * window.height()));
    if (is_odd(data)) require(merge_parts({path(0)}).missing == merge.missing);
  } catch (const Error& error) {
    require(std::string(error.what()).find("dapple_part_") != std::string::npos);
  }
  return 0;
}
