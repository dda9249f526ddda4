// Sections of the file: the settings as JSON, the calls, and compressed values. Of each sample only
// the sides that were traced are stored.
#include "bake/bake_checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "dapple/error.hpp"
#include "files/compression.hpp"
#include "files/sealed_file.hpp"

namespace dapple {
namespace {

using nlohmann::json;

constexpr SealedKind kKind{"bake", 2};

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw Error(ErrorKind::failed,
              fmt::format("--resume {}: {}; without --resume the bake begins anew", path, reason));
}

/// Calls visit(value) for each number of the traced sides of a sample.
template <class Samples, class Visit>
void visit_values(std::span<const SurfaceSample> samples, Samples& found, bool bent,
                  std::size_t lights, Visit visit) {
  const auto visit_side = [&](auto& sides, auto& light, std::size_t i) {
    visit(sides[i].scalar);
    for (int axis = 0; bent && axis < 3; ++axis) visit(sides[i].bent[axis]);
    for (std::size_t l = i * lights; l < (i + 1) * lights; ++l)
      for (int axis = 0; axis < 3; ++axis) visit(light[l][axis]);
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].front) visit_side(found.front, found.front_light, i);
    if (samples[i].back) visit_side(found.back, found.back_light, i);
  }
}

/// Whether any sample has a bent normal.
bool has_bent(const TracedSamples& found) {
  const auto any = [](const std::vector<SideValue>& sides) {
    return std::any_of(sides.begin(), sides.end(),
                       [](const SideValue& side) { return side.bent != V3f(0, 0, 0); });
  };
  return any(found.front) || any(found.back);
}

std::uint64_t value_count(std::span<const SurfaceSample> samples, bool bent, std::uint32_t lights) {
  std::uint64_t sides = 0;
  for (const SurfaceSample& sample : samples)
    sides += static_cast<std::uint64_t>(sample.front) + static_cast<std::uint64_t>(sample.back);
  return sides * (1 + (bent ? 3 : 0) + std::uint64_t{3} * lights);
}

/// Names may have bytes that are not UTF-8: others stand for them.
std::string text_of(const Settings& settings) {
  return json(settings).dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

BakeCheckpoint::BakeCheckpoint(const RenderControl& control, Settings settings)
    : control_(control), settings_(json::parse(text_of(settings)).get<Settings>()) {
  if (!control.resume.empty()) read();
}

void BakeCheckpoint::read() {
  const std::string& path = control_.resume;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw Error(ErrorKind::input, "--resume " + path + ": there is no such file");
  try {
    const SealedFile file = open_sealed_file(path, kKind);
    const std::span<const char> text = file.values<char>(0);
    require_same(path, json::parse(text.begin(), text.end()).get<Settings>(), settings_);
    const std::span<const Call> calls = file.values<Call>(1);
    calls_.assign(calls.begin(), calls.end());
    values_.resize(decompressed_size(file.section(2)) / sizeof(float));
    if (!decompress(file.section(2), std::as_writable_bytes(std::span(values_))))
      refuse(path, "damaged: its values do not unpack");
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    const std::string what = error.what(), name = path + ": ";
    refuse(path, what.starts_with(name) ? what.substr(name.size()) : what);
  } catch (const json::exception& error) {
    refuse(path, fmt::format("damaged: {}", error.what()));
  }
  saved_ = calls_.size();
}

TraceSamples BakeCheckpoint::with(TraceSamples trace) {
  if (control_.checkpoint.empty() && control_.resume.empty()) return trace;
  return [this, trace = std::move(trace)](
             std::span<const SurfaceSample> samples, std::span<const std::uint32_t> placement,
             const Placements& placements, int rays, std::uint32_t hash) {
    if (next_ < calls_.size()) return replay(samples, hash);
    TracedSamples found = trace(samples, placement, placements, rays, hash);
    if (!control_.checkpoint.empty()) record(samples, hash, found);
    return found;
  };
}

TracedSamples BakeCheckpoint::replay(std::span<const SurfaceSample> samples, std::uint32_t hash) {
  const Call& call = calls_[next_++];
  const std::uint64_t count = value_count(samples, call.bent != 0, call.lights);
  if (call.samples != samples.size() || call.hash != hash || call.first > values_.size() ||
      count > values_.size() - call.first)
    refuse(control_.resume, "its samples are not those of this bake");
  TracedSamples found;
  found.front.resize(samples.size());
  found.back.resize(samples.size());
  found.front_light.resize(samples.size() * call.lights, V3f(0, 0, 0));
  found.back_light = found.front_light;
  found.largest = call.largest;
  found.points = call.points;
  found.rays = call.rays;
  const float* next = values_.data() + call.first;
  visit_values(samples, found, call.bent != 0, call.lights, [&](float& value) { value = *next++; });
  points_read_ += call.points;
  return found;
}

void BakeCheckpoint::record(std::span<const SurfaceSample> samples, std::uint32_t hash,
                            const TracedSamples& found) {
  const bool bent = has_bent(found);
  const std::size_t lights = samples.empty() ? 0 : found.front_light.size() / samples.size();
  Call call;
  call.first = values_.size();
  call.samples = samples.size();
  call.points = found.points;
  call.rays = found.rays;
  call.hash = hash;
  call.lights = static_cast<std::uint32_t>(lights);
  call.largest = found.largest;
  call.bent = bent ? 1 : 0;
  calls_.push_back(call);
  next_ = calls_.size();
  visit_values(samples, found, bent, lights, [&](float value) { values_.push_back(value); });
  save(false);
}

void BakeCheckpoint::save(bool now) {
  if (control_.checkpoint.empty() || saved_ == calls_.size()) return;
  if (!now && since_saved_.seconds() < control_.checkpoint_every) return;
  const bool failed_before = !failure_.empty();
  failure_.clear();
  try {
    const std::string about = text_of(settings_);
    const std::vector<std::byte> packed = compress(as_section(values_));
    // Not synced to disk, as those of renders (experiment 805).
    write_sealed_file(control_.checkpoint, kKind,
                      {as_section(about), as_section(calls_), Section(packed)}, Durable::no);
    saved_ = calls_.size();
  } catch (const Error& error) {
    failure_ = error.what();
    if (control_.warn && !failed_before && !now) control_.warn(failure_);
  }
  since_saved_ = Stopwatch();
}

}  // namespace dapple
