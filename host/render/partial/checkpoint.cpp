// Sections of the file: a JSON description, then compressed sums, squares, samples, the work of
// each group of the round, for Cryptomattes what the samples hit, and sums of motion vectors.
// Values have this machine's byte order, which the seal checks.
#include "render/partial/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "dapple/shared/ray.h"
#include "files/sealed_file.hpp"
#include "film/sums/matte_sums.hpp"

namespace dapple {
namespace {

using nlohmann::json;

constexpr SealedKind kKind{"checkpoint", 5};
constexpr std::size_t kFirstGroup = 4;  ///< section of the first group

/// Pixels have at most 2^20 samples, and slices are not larger.
constexpr std::uint32_t kMaxSamples = DAPPLE_MAX_CAMERA_SPLITTING << 20;

constexpr std::size_t kMaxPieces = 1u << 16;

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
  throw Error(ErrorKind::failed, fmt::format("{}: {}", name, reason));
}

json settings_json(const Settings& settings) {
  json list = json::array();
  for (const auto& [name, value] : settings) list.push_back({name, value});
  return list;
}

Settings settings_of(const json& list) { return list.get<Settings>(); }

json pieces_json(const std::vector<Piece>& pieces) {
  json list = json::array();
  for (const auto& [rect, rays] : pieces)
    list.push_back({rect.x0, rect.y0, rect.x1, rect.y1, rays.first, rays.end});
  return list;
}

std::vector<Piece> pieces_of(const json& list, const PixelRect& crop) {
  const Error damaged(ErrorKind::failed, "damaged: its pieces");
  if (list.size() > kMaxPieces) throw damaged;
  std::vector<Piece> pieces;
  for (const json& one : list) {
    const auto corner = [&](std::size_t i) { return one.at(i).get<int>(); };
    pieces.push_back({{corner(0), corner(1), corner(2), corner(3)},
                      {one.at(4).get<std::uint32_t>(), one.at(5).get<std::uint32_t>()}});
  }
  for (const Piece& piece : pieces)
    if (!is_piece_of(crop, piece)) throw damaged;
  return pieces;
}

/// Of a render: one piece if all pixels have the same samples, and none are left to trace.
std::vector<Piece> finished_pieces(const Checkpoint& checkpoint, const TraceState& state) {
  const bool equal = std::all_of(state.samples.begin(), state.samples.end(),
                                 [&](auto count) { return count == state.samples.front(); });
  if (!checkpoint.pieces.empty() || !equal || state.samples.empty() || !state.round.is_done())
    return checkpoint.pieces;
  const std::uint32_t splitting = splitting_factor(checkpoint.picture.options);
  const std::uint32_t first = state.first_sample / splitting;
  return {{checkpoint.picture.crop, {first, first + state.samples.front() / splitting}}};
}

json header(const Checkpoint& checkpoint, const TraceState& state, const Round& round) {
  json groups = json::array();
  for (const SampleGroup& group : round.groups) groups.push_back(group.samples);
  return {{"options", settings_json(checkpoint.options)},
          {"content", settings_json(checkpoint.content)},
          {"footprint_spp", checkpoint.footprint_spp},
          {"footprint", checkpoint.footprint},
          {"device", checkpoint.device},
          {"picture", to_json(checkpoint.picture)},
          {"pieces", pieces_json(finished_pieces(checkpoint, state))},
          {"first_sample", state.first_sample},
          {"pass_seconds", state.pass_seconds},
          {"slice_samples", state.slice_samples},
          {"groups", groups},
          {"mattes", !state.mattes.empty()},
          {"motion", !state.motion.empty()},
          {"position", {round.group, round.entry, round.sample}}};
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

void read_state(const SealedFile& file, const json& about, TraceState& state) {
  state.sums = vector_of<std::int64_t>(file, 1);
  state.squares = vector_of<float>(file, 2);
  state.samples = vector_of<std::uint32_t>(file, 3);
  state.round = round_of(file, about);
  std::size_t section = kFirstGroup + state.round.groups.size();
  if (about.at("mattes").get<bool>()) state.mattes = vector_of<std::uint32_t>(file, section++);
  if (about.at("motion").get<bool>())
    state.motion = MotionSums(vector_of<MotionSums::Sum>(file, section));
}

Checkpoint checkpoint_of(const SealedFile& file, PartContents contents) {
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
  checkpoint.picture = picture_record(about.at("picture"));
  checkpoint.pieces = pieces_of(about.at("pieces"), checkpoint.picture.crop);
  TraceState& state = checkpoint.state;
  state.first_sample = about.at("first_sample").get<std::uint32_t>();
  state.pass_seconds = about.at("pass_seconds").get<std::map<std::string, double>>();
  state.slice_samples = about.at("slice_samples").get<std::uint32_t>();
  if (contents == PartContents::all) read_state(file, about, state);
  return checkpoint;
}

/// `name`: for messages, "--resume F" or a path. `next`: what to do about a damaged file.
Checkpoint read_as(const std::string& name, const std::string& path, PartContents contents,
                   const std::string& next) {
  try {
    return checkpoint_of(open_sealed_file(path, kKind), contents);
  } catch (const Error& error) {
    const std::string text = error.what();
    const std::string prefix = path + ": ";
    std::error_code unknown;
    if (!std::filesystem::exists(path, unknown) && !unknown)
      throw Error(ErrorKind::input, name + ": there is no such file");
    // The file may be as good as it was: who begins anew without it needs another reason.
    if (text.starts_with(prefix + "cannot be read")) throw Error(ErrorKind::failed, text);
    refuse(name, (text.starts_with(prefix) ? text.substr(prefix.size()) : text) + next);
  } catch (const json::exception& error) {
    refuse(name, fmt::format("damaged: {}", error.what()));
  }
}

bool fits(const Round& round, std::uint32_t slice_samples, std::size_t pixels) {
  for (const SampleGroup& group : round.groups) {
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
                      const TraceState& state, Durable durable, CompressionLevel level) {
  // The work of a round that is done is of no use any more.
  const Round none;
  const Round& round = state.round.is_done() ? none : state.round;
  // Paths may have other bytes than UTF-8; names of objects have not.
  const std::string about =
      header(checkpoint, state, round).dump(-1, ' ', false, json::error_handler_t::replace);
  std::vector<std::vector<std::byte>> packed;
  const auto add = [&](Section section) { packed.push_back(compress(section, level)); };
  add(as_section(state.sum_values()));
  add(as_section(state.square_values()));
  add(as_section(state.samples));
  for (const SampleGroup& group : round.groups) add(as_section(group.work));
  if (!state.mattes.empty()) add(as_section(state.mattes));
  if (!state.motion.empty()) add(as_section(state.motion.values()));
  std::vector<Section> sections{as_section(about)};
  for (const std::vector<std::byte>& bytes : packed) sections.emplace_back(bytes);
  // Checkpoints are not synced to disk (experiment 805): after a power failure the checksum shows
  // the damage, and a killed process loses nothing.
  write_sealed_file(path, kKind, sections, durable);
}

Checkpoint read_checkpoint(const std::string& path) {
  return read_as("--resume " + path, path, PartContents::all,
                 "; without --resume the render begins anew");
}

Checkpoint read_part(const std::string& path, PartContents contents) {
  return read_as(path, path, contents, "");
}

StateShape shape_of(const FilmLayout& layout, const RenderOptions& options,
                    const MatteNames& names) {
  const bool mattes = options.cryptomattes.any();
  return {layout.pixels,
          layout.sum_bytes() / sizeof(std::int64_t),
          is_adaptive(options) ? layout.square_bytes() / sizeof(float) : 0,
          mattes ? names.objects.size() : 0,
          mattes ? names.materials.size() : 0,
          options.motion};
}

void check_state(const std::string& name, const TraceState& state, const StateShape& shape) {
  if (state.sums.size() != shape.sums || state.squares.size() != shape.squares ||
      state.samples.size() != shape.pixels) {
    refuse(name, fmt::format("has {} sums, {} squares and {} pixels; this picture has {}, {}, {}",
                             state.sums.size(), state.squares.size(), state.samples.size(),
                             shape.sums, shape.squares, shape.pixels));
  }
  if (shape.objects == 0
          ? !state.mattes.empty()
          : !MatteSums().unpack(state.mattes, shape.pixels, shape.objects, shape.materials)) {
    refuse(name, "damaged: its objects and materials are not of this picture");
  }
  if (state.motion.values().size() != (shape.motion ? shape.pixels : 0))
    refuse(name, "damaged: its motion vectors are not of this picture");
  const bool too_many = std::any_of(state.samples.begin(), state.samples.end(),
                                    [](std::uint32_t samples) { return samples > kMaxSamples; });
  if (too_many || state.first_sample > kMaxSamples || state.slice_samples < DAPPLE_SAMPLE_BATCH ||
      state.slice_samples > kMaxSliceSamples ||
      !fits(state.round, state.slice_samples, shape.pixels)) {
    refuse(name, "damaged: its list of work is not of this picture");
  }
  // The first plane counts the samples that hit.
  for (std::size_t p = 0; p < std::min(shape.pixels, shape.sums); ++p) {
    if (state.sums[p] < 0 || state.sums[p] > state.samples[p])
      refuse(name, "damaged: its samples that hit are not among those that it has");
  }
  try {
    traced_samples(state.round, state.slice_samples, state.samples);
  } catch (const Error& error) {
    refuse(name, fmt::format("damaged: {}", error.what()));
  }
}

}  // namespace dapple
