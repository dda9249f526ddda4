// Tables of glTF properties and the walk that checks a document against them: see
// schema.hpp.
#include "scene/gltf/schema.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "scene/gltf/message.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

enum class Kind {
  index,      ///< integer in [0, 2^31)
  count,      ///< integer in [0, 2^53)
  stride,     ///< integer in [4, 252], a multiple of 4
  number,     ///< finite as a float
  numbers,    ///< array of such numbers
  indices,    ///< array of index
  index_map,  ///< object of index
  text,
  texts,
  boolean,
  object,
  objects,  ///< array of objects
};

struct Rule;

/// A table of rules; a span would need Rule to be complete.
struct Rules {
  const Rule* first = nullptr;
  std::size_t count = 0;
  constexpr Rules() = default;
  template <std::size_t N>
  constexpr Rules(const Rule (&rules)[N]) : first(rules), count(N) {}
  [[nodiscard]] inline const Rule* begin() const;
  [[nodiscard]] inline const Rule* end() const;
};

struct Rule {
  std::string_view key;
  Kind kind;
  Rules children = {};         ///< of object and objects
  std::string_view noun = {};  ///< of objects: what a message calls one of them
  std::size_t length = 0;      ///< of numbers; 0 for any
  bool required = false;
};

const Rule* Rules::begin() const { return first; }
const Rule* Rules::end() const { return first + count; }

constexpr bool kRequired = true;

constexpr Rule required(std::string_view key, Kind kind, Rules children = {}) {
  return {key, kind, children, {}, 0, kRequired};
}

constexpr Rule kAsset[] = {required("version", Kind::text), {"minVersion", Kind::text}};

constexpr Rule kBuffer[] = {{"uri", Kind::text}, required("byteLength", Kind::count)};

constexpr Rule kBufferView[] = {required("buffer", Kind::index),
                                {"byteOffset", Kind::count},
                                required("byteLength", Kind::count),
                                {"byteStride", Kind::stride},
                                {"extensions", Kind::object}};

constexpr Rule kSparseIndices[] = {required("bufferView", Kind::index),
                                   {"byteOffset", Kind::index},
                                   required("componentType", Kind::index)};
constexpr Rule kSparseValues[] = {required("bufferView", Kind::index), {"byteOffset", Kind::index}};
constexpr Rule kSparse[] = {required("count", Kind::index),
                            required("indices", Kind::object, kSparseIndices),
                            required("values", Kind::object, kSparseValues)};
constexpr Rule kAccessor[] = {{"bufferView", Kind::index},
                              {"byteOffset", Kind::count},
                              required("componentType", Kind::index),
                              required("count", Kind::count),
                              required("type", Kind::text),
                              {"normalized", Kind::boolean},
                              {"sparse", Kind::object, kSparse}};

constexpr Rule kImage[] = {{"name", Kind::text},
                           {"uri", Kind::text},
                           {"bufferView", Kind::index},
                           {"mimeType", Kind::text}};

constexpr Rule kSampler[] = {{"magFilter", Kind::index},
                             {"minFilter", Kind::index},
                             {"wrapS", Kind::index},
                             {"wrapT", Kind::index}};

constexpr Rule kTexture[] = {
    {"sampler", Kind::index}, {"source", Kind::index}, {"extensions", Kind::object}};

constexpr Rule kTextureTransform[] = {{"offset", Kind::numbers, {}, {}, 2},
                                      {"rotation", Kind::number},
                                      {"scale", Kind::numbers, {}, {}, 2},
                                      {"texCoord", Kind::index}};
constexpr Rule kTextureInfoExtensions[] = {
    {"KHR_texture_transform", Kind::object, kTextureTransform}};
constexpr Rule kTextureInfo[] = {required("index", Kind::index),
                                 {"texCoord", Kind::index},
                                 {"extensions", Kind::object, kTextureInfoExtensions}};

constexpr Rule kMetallicRoughness[] = {{"baseColorFactor", Kind::numbers, {}, {}, 4},
                                       {"baseColorTexture", Kind::object, kTextureInfo}};
constexpr Rule kSpecularGlossiness[] = {{"diffuseFactor", Kind::numbers, {}, {}, 4},
                                        {"diffuseTexture", Kind::object, kTextureInfo}};
constexpr Rule kEmissiveStrength[] = {{"emissiveStrength", Kind::number}};
constexpr Rule kMaterialExtensions[] = {
    {"KHR_materials_pbrSpecularGlossiness", Kind::object, kSpecularGlossiness},
    {"KHR_materials_emissive_strength", Kind::object, kEmissiveStrength}};
constexpr Rule kMaterial[] = {{"name", Kind::text},
                              {"alphaMode", Kind::text},
                              {"alphaCutoff", Kind::number},
                              {"doubleSided", Kind::boolean},
                              {"emissiveFactor", Kind::numbers, {}, {}, 3},
                              {"emissiveTexture", Kind::object, kTextureInfo},
                              {"pbrMetallicRoughness", Kind::object, kMetallicRoughness},
                              {"extensions", Kind::object, kMaterialExtensions}};

constexpr Rule kPrimitive[] = {required("attributes", Kind::index_map),
                               {"indices", Kind::index},
                               {"material", Kind::index},
                               {"mode", Kind::index},
                               {"targets", Kind::objects, {}, "target"},
                               {"extensions", Kind::object}};
constexpr Rule kMesh[] = {{"name", Kind::text},
                          {"primitives", Kind::objects, kPrimitive, "primitive", 0, kRequired},
                          {"weights", Kind::numbers}};

constexpr Rule kNodeLight[] = {required("light", Kind::index)};
constexpr Rule kGpuInstancing[] = {required("attributes", Kind::index_map)};
constexpr Rule kNodeExtensions[] = {{"KHR_lights_punctual", Kind::object, kNodeLight},
                                    {"EXT_mesh_gpu_instancing", Kind::object, kGpuInstancing}};
constexpr Rule kNode[] = {{"name", Kind::text},
                          {"mesh", Kind::index},
                          {"camera", Kind::index},
                          {"skin", Kind::index},
                          {"children", Kind::indices},
                          {"matrix", Kind::numbers, {}, {}, 16},
                          {"translation", Kind::numbers, {}, {}, 3},
                          {"rotation", Kind::numbers, {}, {}, 4},
                          {"scale", Kind::numbers, {}, {}, 3},
                          {"extensions", Kind::object, kNodeExtensions}};

constexpr Rule kPerspective[] = {required("yfov", Kind::number), required("znear", Kind::number)};
constexpr Rule kOrthographic[] = {required("xmag", Kind::number), required("ymag", Kind::number),
                                  required("zfar", Kind::number), required("znear", Kind::number)};
constexpr Rule kCamera[] = {{"name", Kind::text},
                            required("type", Kind::text),
                            {"perspective", Kind::object, kPerspective},
                            {"orthographic", Kind::object, kOrthographic}};

constexpr Rule kScene[] = {{"name", Kind::text}, {"nodes", Kind::indices}};

constexpr Rule kSpot[] = {{"innerConeAngle", Kind::number}, {"outerConeAngle", Kind::number}};
constexpr Rule kLight[] = {{"name", Kind::text},
                           required("type", Kind::text),
                           {"color", Kind::numbers, {}, {}, 3},
                           {"intensity", Kind::number},
                           {"spot", Kind::object, kSpot}};
constexpr Rule kLights[] = {{"lights", Kind::objects, kLight, "light", 0, kRequired}};
constexpr Rule kExtensions[] = {{"KHR_lights_punctual", Kind::object, kLights}};

constexpr Rule kRoot[] = {required("asset", Kind::object, kAsset),
                          {"extensionsUsed", Kind::texts},
                          {"extensionsRequired", Kind::texts},
                          {"scene", Kind::index},
                          {"buffers", Kind::objects, kBuffer, "buffer"},
                          {"bufferViews", Kind::objects, kBufferView, "bufferView"},
                          {"accessors", Kind::objects, kAccessor, "accessor"},
                          {"images", Kind::objects, kImage, "image"},
                          {"samplers", Kind::objects, kSampler, "sampler"},
                          {"textures", Kind::objects, kTexture, "texture"},
                          {"materials", Kind::objects, kMaterial, "material"},
                          {"meshes", Kind::objects, kMesh, "mesh"},
                          {"nodes", Kind::objects, kNode, "node"},
                          {"cameras", Kind::objects, kCamera, "camera"},
                          {"scenes", Kind::objects, kScene, "scene"},
                          {"extensions", Kind::object, kExtensions}};

class Checker {
 public:
  explicit Checker(const std::string& file) : file_(file) {}

  void check_object(Json& object, Rules rules, const std::string& where) const {
    for (const Rule& rule : rules) {
      const auto found = object.find(rule.key);
      if (found != object.end()) {
        check_value(*found, rule, where);
      } else if (rule.required) {
        fail(file_, "{}{} is missing", prefix(where), rule.key);
      }
    }
  }

 private:
  static std::string prefix(const std::string& where) { return where.empty() ? "" : where + ": "; }

  [[noreturn]] void refuse(const Rule& rule, const std::string& where,
                           std::string_view expected) const {
    fail(file_, "{}{} is not {}", prefix(where), rule.key, expected);
  }

  void check_integer(Json& value, const Rule& rule, const std::string& where, double limit) const {
    const bool is_number = value.is_number();
    const double number = is_number ? value.get<double>() : -1.0;
    if (!(number >= 0 && number < limit) || number != std::floor(number)) {
      refuse(rule, where, fmt::format("an integer from 0 to {:.0f}", limit - 1));
    }
    if (value.is_number_float()) value = static_cast<std::uint64_t>(number);
  }

  void check_index(Json& value, const Rule& rule, const std::string& where) const {
    check_integer(value, rule, where, 0x1p31);
  }

  /// Turns integers into floating point as well: tinygltf keeps those in extensions as ints.
  void check_number(Json& value, const Rule& rule, const std::string& where) const {
    const bool fits = value.is_number() &&
                      std::abs(value.get<double>()) <= double{std::numeric_limits<float>::max()};
    if (!fits) refuse(rule, where, "a number that a float can hold");
    value = value.get<double>();
  }

  void check_numbers(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_array()) refuse(rule, where, "an array of numbers");
    if (rule.length != 0 && value.size() != rule.length) {
      fail(file_, "{}{} has {} numbers, not {}", prefix(where), rule.key, value.size(),
           rule.length);
    }
    for (Json& item : value) check_number(item, rule, where);
  }

  void check_objects(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_array()) refuse(rule, where, "an array");
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string item =
          fmt::format("{}{}{} {}", where, where.empty() ? "" : " ", rule.noun, i);
      if (!value[i].is_object()) fail(file_, "{} is not an object", item);
      check_object(value[i], rule.children, item);
    }
  }

  void check_value(Json& value, const Rule& rule, const std::string& where) const {
    switch (rule.kind) {
      case Kind::index:
        return check_index(value, rule, where);
      case Kind::count:
        return check_integer(value, rule, where, 0x1p53);
      case Kind::stride:
        check_integer(value, rule, where, 253);
        if (value.get<int>() < 4 || value.get<int>() % 4 != 0) {
          refuse(rule, where, "a multiple of 4 from 4 to 252");
        }
        return;
      case Kind::number:
        return check_number(value, rule, where);
      case Kind::numbers:
        return check_numbers(value, rule, where);
      case Kind::indices:
        if (!value.is_array()) refuse(rule, where, "an array of integers");
        for (Json& item : value) check_index(item, rule, where);
        return;
      case Kind::index_map:
        if (!value.is_object()) refuse(rule, where, "an object");
        for (Json& item : value) check_index(item, rule, where);
        return;
      case Kind::text:
        if (!value.is_string()) refuse(rule, where, "a string");
        return;
      case Kind::texts:
        if (!value.is_array()) refuse(rule, where, "an array of strings");
        for (const Json& item : value) {
          if (!item.is_string()) refuse(rule, where, "an array of strings");
        }
        return;
      case Kind::boolean:
        if (!value.is_boolean()) refuse(rule, where, "true or false");
        return;
      case Kind::object:
        if (!value.is_object()) refuse(rule, where, "an object");
        return check_object(value, rule.children,
                            fmt::format("{}{}{}", where, where.empty() ? "" : " ", rule.key));
      case Kind::objects:
        return check_objects(value, rule, where);
    }
  }

  const std::string& file_;
};

}  // namespace

void check_schema(Json& root, const std::string& file) {
  if (!root.is_object()) fail(file, "is not a glTF document (its JSON is no object)");
  Checker(file).check_object(root, kRoot, "");
}

}  // namespace dapple::gltf
