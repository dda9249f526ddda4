// Reads checkpoints that dapple did not write: any bytes, or sealed and compressed files with a
// right checksum around any contents. A file is refused, or all of its slices are within bounds.
#include <fuzzer/FuzzedDataProvider.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "dapple/error.hpp"
#include "dapple/shared/ray.h"
#include "files/compression.hpp"
#include "files/sealed_file.hpp"
#include "render/partial/checkpoint.hpp"

namespace {

using namespace dapple;

constexpr std::size_t kPixels = 6;
constexpr int kMaxSlices = 10'000;

const std::string& path() {
  static const std::string name =
      std::filesystem::temp_directory_path() / ("dapple_fuzz_" + std::to_string(getpid()));
  return name;
}

void require(bool condition) {
  if (!condition) std::abort();
}

/// Advances through the rest of the round as tracing does, and checks each slice.
void trace(Round round, std::uint32_t slice_samples) {
  for (int slices = 0; !round.is_done() && slices < kMaxSlices; ++slices) {
    const SliceParams slice = next_slice(round, slice_samples);
    const SampleGroup& group = round.groups[round.group];
    require(slice.pixel_count > 0 && slice.sample_count > 0);
    require(std::size_t{slice.first_work} + slice.pixel_count <= group.work.size());
    require(std::uint64_t{slice.pixel_count} * slice.sample_count <= slice_samples);
    require(slice.first_sample + slice.sample_count <= group.samples);
    for (std::uint32_t i = 0; i < slice.pixel_count; ++i)
      require(group.work[slice.first_work + i].pixel < kPixels);
    advance(round, slice_samples);
  }
}

void read() {
  try {
    const Checkpoint checkpoint = read_checkpoint(path());
    const TraceState& state = checkpoint.state;
    check_state("--resume " + path(), state, {kPixels, state.sums.size(), state.squares.size()});
    for (const std::uint32_t samples :
         traced_samples(state.round, state.slice_samples, state.samples))
      require(samples <= DAPPLE_MAX_CAMERA_SPLITTING << 20);
    trace(state.round, state.slice_samples);
  } catch (const Error& error) {
    require(std::string(error.what()).find("--resume " + path() + ": ") == 0);
  }
}

void write_raw(FuzzedDataProvider& data) {
  const std::string bytes = data.ConsumeRemainingBytesAsString();
  std::ofstream(path(), std::ios::binary) << bytes;
}

void seal(const std::string& about, const std::vector<std::vector<std::byte>>& packed) {
  std::vector<Section> sections{as_section(about)};
  for (const auto& bytes : packed) sections.emplace_back(bytes);
  write_sealed_file(path(), {"checkpoint", 5}, sections, Durable::no);
}

std::vector<std::byte> any_bytes(FuzzedDataProvider& data) {
  return data.ConsumeBytes<std::byte>(data.ConsumeIntegralInRange<std::size_t>(0, 64));
}

/// Any text as the header, and any sections, compressed or not.
void write_any(FuzzedDataProvider& data) {
  const std::string about = data.ConsumeRandomLengthString();
  std::vector<std::vector<std::byte>> packed;
  for (int i = data.ConsumeIntegralInRange(0, 6); i > 0; --i)
    packed.push_back(data.ConsumeBool() ? compress(any_bytes(data)) : any_bytes(data));
  seal(about, packed);
}

/// A file that is similar to a checkpoint: its numbers are in or near the valid ranges.
void write_likely(FuzzedDataProvider& data) {
  const auto number = [&](std::uint32_t max) {
    return data.ConsumeBool() ? data.ConsumeIntegralInRange<std::uint32_t>(0, max)
                              : data.ConsumeIntegral<std::uint32_t>();
  };
  TraceState state;
  state.sums.resize(data.ConsumeIntegralInRange(0, 3));
  for (std::size_t p = 0; p < kPixels; ++p) state.samples.push_back(number(64));
  std::vector<std::vector<std::byte>> packed{
      compress(as_section(state.sums)), {}, compress(as_section(state.samples))};
  nlohmann::json groups = nlohmann::json::array();
  for (int g = data.ConsumeIntegralInRange(0, 3); g > 0; --g) {
    groups.push_back(number(32));
    std::vector<PixelWork> work(data.ConsumeIntegralInRange<std::size_t>(0, kPixels + 1));
    for (PixelWork& one : work) one = {number(kPixels), number(64)};
    packed.push_back(compress(as_section(work)));
  }
  const nlohmann::json about = {
      {"options", nlohmann::json::array()},
      {"content", nlohmann::json::array()},
      {"footprint_spp", number(16)},
      {"footprint", number(16)},
      {"device", "fuzz"},
      {"pass_seconds", nlohmann::json::object()},
      {"picture", to_json(PictureRecord{})},
      {"pieces", nlohmann::json::array()},
      {"first_sample", number(64)},
      {"mattes", data.ConsumeBool()},
      {"motion", data.ConsumeBool()},
      {"slice_samples", number(32)},
      {"groups", groups},
      {"position", {number(2), number(kPixels), number(32)}},
  };
  seal(about.dump(), packed);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  switch (data.ConsumeIntegralInRange(0, 2)) {
    case 0:
      write_raw(data);
      break;
    case 1:
      write_any(data);
      break;
    default:
      write_likely(data);
  }
  read();
  return 0;
}
