// Counts the values of a JSON text, finds double keys, and parses it: see json_text.hpp.
#include "scene/gltf/document/json_text.hpp"

#include <nlohmann/json.hpp>

#include "scene/json_structure.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

/// A larger text probably has buffers in data: URIs, which should be separate files.
constexpr std::size_t kMaxJsonBytes = std::size_t{256} << 20;
constexpr std::size_t kMaxDepth = 256;
/// Two characters may be an object, which takes up to 0.7 kB until it is in the scene; the limit
/// then means 3 GB in all.
constexpr std::size_t kMaxContainers = std::size_t{1} << 22;
/// Another value takes 16 bytes, and 32 while its array grows.
constexpr std::size_t kMaxValues = std::size_t{1} << 25;

struct Counts {
  std::size_t depth = 0;
  std::size_t containers = 0;
  std::size_t values = 0;
};

void check_counts(const Counts& counts, std::size_t at, const std::string& file) {
  if (counts.depth > kMaxDepth) {
    fail(file, "JSON is nested deeper than {} levels (byte {})", kMaxDepth, grouped(at));
  }
  if (counts.containers > kMaxContainers) {
    fail(file, "JSON has more than {} objects and arrays (byte {})", grouped(kMaxContainers),
         grouped(at));
  }
  if (counts.values > kMaxValues) {
    fail(file, "JSON has more than {} values (byte {})", grouped(kMaxValues), grouped(at));
  }
}

void check_size(std::string_view json, const std::string& file) {
  if (json.size() > kMaxJsonBytes) {
    fail(file, "its JSON is too large ({} bytes, at most {}); keep buffers in .bin files or GLB",
         grouped(json.size()), grouped(kMaxJsonBytes));
  }
  Counts counts;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      ++counts.depth;
      ++counts.containers;
      check_counts(counts, i, file);
    } else if (c == ',') {
      ++counts.values;
      check_counts(counts, i, file);
    } else if ((c == '}' || c == ']') && counts.depth > 0) {
      --counts.depth;
    }
  }
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  check_size(text, file);
  const std::string defect = json_structure_defect(text, kMaxDepth);  // glTF 2.0, section 2.7
  if (!defect.empty()) fail(file, "JSON {}", defect);
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    const std::string what = error.what();  // "[json.exception...] parse error at line 1, ..."
    const std::size_t bracket = what.find("] ");
    fail(file, "is not glTF: {}", bracket == std::string::npos ? what : what.substr(bracket + 2));
  }
}

}  // namespace dapple::gltf
