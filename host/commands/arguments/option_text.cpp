#include "commands/arguments/option_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>
#include <vector>

#include "commands/arguments/choice.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

/// The parts between characters `at`, without blanks around them.
std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == at) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  for (std::string& part : parts) {
    part.erase(0, std::min(part.find_first_not_of(' '), part.size()));
    part.erase(part.find_last_not_of(' ') + 1);
  }
  return parts;
}

/// The whole of `text` as a finite number, or an error.
template <class Number>
Number parse_number(const std::string& flag, const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole_text = end == text.data() + text.size() && !text.empty();
  if (is_whole_text && error == std::errc::result_out_of_range)
    throw Error(ErrorKind::usage, fmt::format("{}: '{}' is out of range", flag, text));
  if (is_whole_text && error == std::errc{} && std::isfinite(static_cast<double>(value)))
    return value;
  throw Error(ErrorKind::usage, fmt::format("{}: '{}' is not a {}number", flag, text,
                                            std::is_integral_v<Number> ? "whole " : ""));
}

template <class Number>
std::vector<Number> parse_numbers(const std::string& flag, const std::string& text,
                                  std::size_t count, const char* shape) {
  const auto parts = split(text, ',');
  if (parts.size() != count)
    throw Error(ErrorKind::usage, fmt::format("{} {}: expected {}", flag, text, shape));
  std::vector<Number> numbers;
  for (const std::string& part : parts) numbers.push_back(parse_number<Number>(flag, part));
  return numbers;
}

}  // namespace

V3f parse_vector(const std::string& flag, const std::string& text) {
  const auto v = parse_numbers<float>(flag, text, 3, "X,Y,Z");
  return {v[0], v[1], v[2]};
}

PixelRect parse_crop(const std::string& text) {
  const auto v = parse_numbers<int>("--crop", text, 4, "X0,Y0,X1,Y1");
  return {v[0], v[1], v[2], v[3]};
}

float parse_share(const std::string& flag, const std::string& text) {
  const bool is_percentage = text.ends_with('%');
  const float value =
      parse_number<float>(flag, is_percentage ? text.substr(0, text.size() - 1) : text);
  const float share = is_percentage || value >= 1 ? value / 100 : value;
  if (share >= 0 && share <= 1) return share;
  throw Error(ErrorKind::usage,
              fmt::format("{} {}: expected 0% to 100%, as in 2% or 0.02", flag, text));
}

std::pair<std::string, float> parse_opacity(const std::string& text) {
  const auto at = text.rfind('=');
  if (at == std::string::npos || at == 0) {
    throw Error(ErrorKind::usage,
                fmt::format("--opacity {}: expected MATERIAL=VALUE, as in leaf=0.85", text));
  }
  return {text.substr(0, at),
          parse_number<float>("--opacity " + text.substr(0, at), text.substr(at + 1))};
}

std::pair<double, double> parse_shutter(const std::string& text) {
  const auto times = parse_numbers<double>("--shutter", text, 2, "OPEN,CLOSE, as in -0.25,0.25");
  for (const double time : times)
    if (!(std::abs(time) <= 1e6))
      throw Error(ErrorKind::usage,
                  fmt::format("--shutter {}: both must be from -1e6 to 1e6 frames", text));
  return {times[0], times[1]};
}

FrameRange parse_frames(const std::string& text) {
  constexpr std::int64_t kMaxFrames = 100'000, kLargestNumber = 1'000'000'000;
  const auto fail = [&](const char* expected) {
    throw Error(ErrorKind::usage, fmt::format("--frames {}: expected {}", text, expected));
  };
  const auto parts = split(text, ':');
  const auto ends = split(parts[0], '-');
  if (parts.size() > 2 || ends.size() > 2) fail("A-B or A-B:STEP, as in 1-24 or 0-100:10");
  FrameRange range;
  range.first = parse_number<std::int64_t>("--frames", ends.front());
  range.last = parse_number<std::int64_t>("--frames", ends.back());
  if (parts.size() == 2) range.step = parse_number<std::int64_t>("--frames", parts[1]);
  if (range.last < range.first) fail("the first frame before the last");
  if (range.last > kLargestNumber || range.step < 1 || range.step > kLargestNumber)
    fail("numbers up to 1000000000, and a step of 1 or more");
  if (range.count() > kMaxFrames) fail("at most 100000 frames");
  return range;
}

Shard parse_shard(const std::string& text) {
  const auto parts = split(text, '/');
  if (parts.size() != 2)
    throw Error(ErrorKind::usage, fmt::format("--shard {}: expected I/N, as in 2/8", text));
  return {parse_number<int>("--shard", parts[0]), parse_number<int>("--shard", parts[1])};
}

Estimator parse_estimator(const std::string& text) {
  return parse_choice<Estimator>(
      "--estimator", text, {{"exact", Estimator::exact}, {"prefiltered", Estimator::prefiltered}});
}

Cryptomattes parse_cryptomattes(const std::string& text) {
  Cryptomattes mattes;
  for (const std::string& name : parse_names("--cryptomatte", text)) {
    if (name == "object")
      mattes.objects = true;
    else if (name == "material")
      mattes.materials = true;
    else
      throw Error(ErrorKind::usage,
                  fmt::format("--cryptomatte {}: there are object and material", text));
  }
  return mattes;
}

ExrCompression parse_compression(const std::string& text) {
  return parse_choice<ExrCompression>("--compression", text,
                                      {{"zip", ExrCompression::zip},
                                       {"zips", ExrCompression::zips},
                                       {"piz", ExrCompression::piz},
                                       {"dwaa", ExrCompression::dwaa},
                                       {"none", ExrCompression::none}});
}

std::vector<std::string> parse_names(const std::string& flag, const std::string& text) {
  if (text.empty()) return {};
  std::vector<std::string> names = split(text, ',');
  for (const std::string& name : names)
    if (name.empty())
      throw Error(ErrorKind::usage,
                  fmt::format("{} {}: expected names with commas between", flag, text));
  return names;
}

double parse_seconds(const std::string& flag, const std::string& text) {
  const std::string units = "smh";
  const std::size_t unit = text.empty() ? std::string::npos : units.find(text.back());
  const bool plain = unit == std::string::npos;
  double seconds = 0;
  try {
    seconds = parse_number<double>(flag, plain ? text : text.substr(0, text.size() - 1));
  } catch (const Error&) {  // refused below, with examples
  }
  for (std::size_t i = 0; !plain && i < unit; ++i) seconds *= 60;
  if (seconds > 0 && seconds <= 1e9) return seconds;
  throw Error(ErrorKind::usage,
              fmt::format("{} {}: expected a time above 0, as in 30, 30s, 5m or 1h", flag, text));
}

PngOptions parse_png_options(const std::string& exposure, const std::string& background) {
  PngOptions options;
  if (exposure != "auto") options.exposure = parse_number<float>("--exposure", exposure);
  validate(options);
  if (background == "sky") return options;
  options.background = PngOptions::Background::none;
  if (background == "none") return options;
  options.background = PngOptions::Background::color;
  if (background.find(',') == std::string::npos)
    throw Error(ErrorKind::usage,
                fmt::format("--background {}: it is sky, none or R,G,B from 0 to 1", background));
  const auto color = parse_numbers<float>("--background", background, 3, "R,G,B");
  options.color = V3f(color[0], color[1], color[2]);
  validate(options);
  return options;
}

Normals parse_normals(const std::string& text) {
  return parse_choice<Normals>("--normals", text,
                               {{"shading", Normals::shading}, {"geometric", Normals::geometric}});
}

Packets parse_packets(const std::string& text) {
  return parse_choice<Packets>("--packets", text,
                               {{"auto", Packets::automatic},
                                {"none", Packets::none},
                                {"pixel", Packets::pixel},
                                {"point", Packets::point},
                                {"scalar", Packets::scalar}});
}

void parse_passes(const std::string& text, RenderOptions& options) {
  static const std::vector<std::pair<const char*, bool RenderOptions::*>> kPasses = {
      {"ao", &RenderOptions::ao},         {"light", &RenderOptions::light},
      {"albedo", &RenderOptions::albedo}, {"beauty", &RenderOptions::beauty},
      {"back", &RenderOptions::back},     {"motion", &RenderOptions::motion},
      {"visits", &RenderOptions::visits}};
  for (const auto& [name, is_on] : kPasses) options.*is_on = false;
  for (const std::string& pass : split(text, ',')) {
    const auto found = std::find_if(kPasses.begin(), kPasses.end(),
                                    [&](const auto& known) { return pass == known.first; });
    if (found == kPasses.end())
      throw Error(
          ErrorKind::usage,
          fmt::format("--passes {}: there are ao, light, albedo, beauty, back, motion and visits",
                      text));
    options.*found->second = true;
  }
  if (options.beauty) options.light = true;  // RGB has the lights of that pass
  if (options.back && !options.ao && !options.light)
    throw Error(
        ErrorKind::usage,
        fmt::format("--passes {}: back is the other side of ao or light: name one, too", text));
}

}  // namespace dapple
