// Sections of the file: a JSON description, then compressed sums, squares, samples, the work of
// each group of the round, and for Cryptomattes what the samples hit. Values have this machine's
// byte order, which the seal checks.
#include "render/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "dapple/error.hpp"
#include "dapple/shared/ray.h"
#include "files/compression.hpp"
#include "files/sealed_file.hpp"
#include "film/matte_sums.hpp"

namespace dapple {
namespace {

using nlohmann::json;

constexpr SealedKind kKind{"checkpoint", 3};
constexpr std::size_t kFirstGroup = 4;  ///< section of the first group

/// Pixels have at most 2^20 samples, and slices are not larger.
constexpr std::uint32_t kMaxSamples = DAPPLE_MAX_CAMERA_SPLITTING << 20;

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw Error(ErrorKind::failed, fmt::format("--resume {}: {}", path, reason));
}

json settings_json(const Settings& settings) {
  json list = json::array();
  for (const auto& [name, value] : settings) list.push_back({name, value});
  return list;
}

Settings settings_of(const json& list) { return list.get<Settings>(); }

json header(const Checkpoint& checkpoint, const TraceState& state) {
  json groups = json::array();
  for (const WorkGroup& group : state.round.groups) groups.push_back(group.samples);
  return {{"options", settings_json(checkpoint.options)},
          {"content", settings_json(checkpoint.content)},
          {"footprint_spp", checkpoint.footprint_spp},
          {"footprint", checkpoint.footprint},
          {"device", checkpoint.device},
          {"pass_seconds", state.pass_seconds},
          {"slice_samples", state.slice_samples},
          {"groups", groups},
          {"mattes", !state.mattes.empty()},
          {"position", {state.round.group, state.round.entry, state.round.sample}}};
}

template <class T>
std::vector<T> vector_of(const SealedFile& file, std::size_t section) {
  const Section frames = file.section(section);
  const std::size_t bytes = decompressed_size(frames);
  std::vector<T> values(bytes / sizeof(T));
  if (bytes % sizeof(T) != 0 || !decompress(frames, std::as_writable_bytes(std::span(values)))) {
    throw Error(ErrorKind::failed, fmt::format("damaged: section {} does not unpack", section));
  }
  return values;
}

Round round_of(const SealedFile& file, const json& about) {
  Round round;
  for (const std::uint32_t samples : about.at("groups").get<std::vector<std::uint32_t>>())
    round.groups.push_back(
        {samples, vector_of<PixelWork>(file, kFirstGroup + round.groups.size())});
  const auto position = about.at("position").get<std::array<std::uint32_t, 3>>();
  round.group = position[0];
  round.entry = position[1];
  round.sample = position[2];
  return round;
}

Checkpoint checkpoint_of(const SealedFile& file) {
  const std::span<const char> text = file.values<char>(0);
  const json about = json::parse(text.begin(), text.end());
  Checkpoint checkpoint;
  checkpoint.options = settings_of(about.at("options"));
  checkpoint.content = settings_of(about.at("content"));
  checkpoint.footprint_spp = about.at("footprint_spp").get<int>();
  checkpoint.footprint = about.at("footprint").get<float>();
  if (!(checkpoint.footprint >= 0 && checkpoint.footprint <= 1e6f))
    throw Error(ErrorKind::failed, "damaged: its footprint is out of range");
  checkpoint.device = about.at("device").get<std::string>();
  TraceState& state = checkpoint.state;
  state.pass_seconds = about.at("pass_seconds").get<std::map<std::string, double>>();
  state.slice_samples = about.at("slice_samples").get<std::uint32_t>();
  state.sums = vector_of<std::int64_t>(file, 1);
  state.squares = vector_of<float>(file, 2);
  state.samples = vector_of<std::uint32_t>(file, 3);
  state.round = round_of(file, about);
  if (about.value("mattes", false))
    state.mattes = vector_of<std::uint32_t>(file, kFirstGroup + state.round.groups.size());
  return checkpoint;
}

bool fits(const Round& round, std::uint32_t slice_samples, std::size_t pixels) {
  for (const WorkGroup& group : round.groups) {
    if (group.samples < 1 || group.samples > kMaxSamples) return false;
    if (group.work.empty() || group.work.size() > pixels) return false;
    for (const PixelWork& work : group.work)
      if (work.pixel >= pixels || work.first_sample > kMaxSamples) return false;
  }
  if (round.is_done()) return true;
  if (round.entry >= round.groups[round.group].work.size()) return false;
  if (round.sample >= round.groups[round.group].samples) return false;
  Round begun = round;
  begun.entry = begun.sample = 0;
  const SliceParams whole = next_slice(begun, slice_samples);
  return round.entry % std::max(1u, whole.pixel_count) == 0 &&
         round.sample % whole.sample_count == 0;
}

}  // namespace

void write_checkpoint(const std::string& path, const Checkpoint& checkpoint,
                      const TraceState& state) {
  const std::string about = header(checkpoint, state).dump();
  std::vector<std::vector<std::byte>> packed{compress(as_section(state.sums)),
                                             compress(as_section(state.squares)),
                                             compress(as_section(state.samples))};
  for (const WorkGroup& group : state.round.groups)
    packed.push_back(compress(as_section(group.work)));
  if (!state.mattes.empty()) packed.push_back(compress(as_section(state.mattes)));
  std::vector<Section> sections{as_section(about)};
  for (const std::vector<std::byte>& bytes : packed) sections.emplace_back(bytes);
  // Not synced to disk (experiment 805): after a power failure the checksum shows the damage, and a
  // killed process loses nothing.
  write_sealed_file(path, kKind, sections, Durable::no);
}

Checkpoint read_checkpoint(const std::string& path) {
  try {
    return checkpoint_of(open_sealed_file(path, kKind));
  } catch (const Error& error) {
    const std::string what = error.what();
    const std::string name = path + ": ";
    refuse(path, (what.starts_with(name) ? what.substr(name.size()) : what) +
                     "; without --resume the render begins anew");
  } catch (const json::exception& error) {
    refuse(path, fmt::format("damaged: {}", error.what()));
  }
}

void check_state(const std::string& path, const TraceState& state, const StateShape& shape) {
  if (state.sums.size() != shape.sums || state.squares.size() != shape.squares ||
      state.samples.size() != shape.pixels) {
    refuse(path, fmt::format("has {} sums, {} squares and {} pixels; this picture has {}, {}, {}",
                             state.sums.size(), state.squares.size(), state.samples.size(),
                             shape.sums, shape.squares, shape.pixels));
  }
  if (shape.objects == 0
          ? !state.mattes.empty()
          : !MatteSums().unpack(state.mattes, shape.pixels, shape.objects, shape.materials)) {
    refuse(path, "damaged: its objects and materials are not of this picture");
  }
  const bool too_many = std::any_of(state.samples.begin(), state.samples.end(),
                                    [](std::uint32_t samples) { return samples > kMaxSamples; });
  if (too_many || state.slice_samples < DAPPLE_SAMPLE_BATCH || state.slice_samples > kMaxSamples ||
      !fits(state.round, state.slice_samples, shape.pixels)) {
    refuse(path, "damaged: its list of work is not of this picture");
  }
  try {
    traced_samples(state.round, state.slice_samples, state.samples);
  } catch (const Error& error) {
    refuse(path, fmt::format("damaged: {}", error.what()));
  }
}

}  // namespace dapple
