// Reads and checks "key=value&key=value": see parameters.hpp.
#include "scene/procedural/parameters.hpp"

#include <fmt/format.h>

#include <cassert>
#include <charconv>
#include <cmath>

#include "dapple/error.hpp"

namespace dapple {
namespace {

double read_number(const std::string& scene, const ProceduralParameter& parameter,
                   std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: {}={} is not a number", scene, parameter.name, text));
  }
  // The comparison is negated, so that a NaN is outside too.
  if (!(value >= parameter.minimum && value <= parameter.maximum)) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: {}={} is outside [{}, {}]", scene, parameter.name, text,
                            parameter.minimum, parameter.maximum));
  }
  if (parameter.whole && value != std::floor(value)) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: {}={} is not a whole number", scene, parameter.name, text));
  }
  return value;
}

std::string list_names(const std::vector<ProceduralParameter>& table) {
  std::string names;
  for (const ProceduralParameter& parameter : table) {
    names += (names.empty() ? "" : ", ") + parameter.name;
  }
  return names.empty() ? "none" : names;
}

}  // namespace

ProceduralParameters::ProceduralParameters(const ProceduralHelp& scene, std::string_view query,
                                           std::optional<double> time)
    : scene_("scene:" + scene.name),
      table_(scene.parameters),
      given_(scene.parameters.size(), false),
      time_(time) {
  for (const ProceduralParameter& parameter : table_) values_.push_back(parameter.default_value);
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    assign(query.substr(0, end));
    query = end == std::string_view::npos ? std::string_view{} : query.substr(end + 1);
  }
}

void ProceduralParameters::assign(std::string_view pair) {
  const std::size_t equals = pair.find('=');
  if (equals == std::string_view::npos) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: \"{}\" is not of the form key=value", scene_, pair));
  }
  const std::string_view key = pair.substr(0, equals);
  const std::size_t index = find(key);
  if (index == table_.size()) {
    throw Error(ErrorKind::usage, fmt::format("{}: there is no parameter \"{}\"; there are: {}",
                                              scene_, key, list_names(table_)));
  }
  if (given_[index]) {
    throw Error(ErrorKind::usage, fmt::format("{}: {} is given twice", scene_, key));
  }
  given_[index] = true;
  values_[index] = read_number(scene_, table_[index], pair.substr(equals + 1));
}

std::size_t ProceduralParameters::find(std::string_view name) const {
  std::size_t index = 0;
  while (index < table_.size() && table_[index].name != name) ++index;
  return index;
}

double ProceduralParameters::value_of(std::string_view name) const {
  const std::size_t index = find(name);
  assert(index < table_.size());
  return values_[index];
}

float ProceduralParameters::real(std::string_view name) const {
  return static_cast<float>(value_of(name));
}

std::uint32_t ProceduralParameters::whole(std::string_view name) const {
  return static_cast<std::uint32_t>(value_of(name));
}

}  // namespace dapple
