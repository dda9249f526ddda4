// The rules for the properties of glTF 2.0 and of the extensions that dapple reads, from the leaves
// to the root: see schema_rules.hpp. `name`, `extensions` and `extras` are allowed everywhere and
// are not listed.
#include "scene/gltf/document/schema_rules.hpp"

#include "scene/gltf/document/extension_names.hpp"

namespace dapple::gltf {
namespace {

/// The maximum number of elements. One element may be two characters of JSON, and tinygltf's object
/// for it takes some hundred bytes to some kilobytes.
constexpr std::size_t kMany = std::size_t{1} << 22;  // nodes, accessors: up to 0.7 kB
constexpr std::size_t kFew = std::size_t{1} << 17;   // materials: 3 kB

/// How far a colour may lie outside of [0, 1]: exporters round.
constexpr double kRounding = 1e-3;

constexpr Rule required(Rule rule) {
  rule.required = true;
  return rule;
}

constexpr Rule number(std::string_view key, double low, double high = Rule{}.high) {
  return {.key = key, .kind = Kind::number, .low = low, .high = high};
}

constexpr Rule numbers(std::string_view key, std::size_t length) {
  return {.key = key, .kind = Kind::numbers, .length = length};
}

constexpr Rule numbers(std::string_view key, std::size_t length, double low,
                       double high = Rule{}.high) {
  return {.key = key, .kind = Kind::numbers, .length = length, .low = low, .high = high};
}

constexpr Rule color(std::string_view key, std::size_t length) {
  return numbers(key, length, -kRounding, 1 + kRounding);
}

constexpr Rule word(std::string_view key, Table<std::string_view> words) {
  return {.key = key, .kind = Kind::word, .words = words};
}

constexpr Rule code(std::string_view key, Table<int> codes) {
  return {.key = key, .kind = Kind::code, .codes = codes};
}

constexpr Rule object(std::string_view key, Rules children) {
  return {.key = key, .kind = Kind::object, .children = children};
}

constexpr Rule objects(std::string_view key, Rules children, std::string_view noun,
                       std::size_t max_length) {
  return {
      .key = key, .kind = Kind::objects, .children = children, .noun = noun, .length = max_length};
}

constexpr Rule kAsset[] = {required({"version", Kind::text}),
                           {"minVersion", Kind::text},
                           {"generator", Kind::text},
                           {"copyright", Kind::text}};

constexpr Rule kBuffer[] = {{"uri", Kind::text}, required({"byteLength", Kind::size})};

constexpr std::string_view kMeshoptModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
constexpr std::string_view kMeshoptFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
constexpr Rule kMeshopt[] = {
    required({"buffer", Kind::index}),    {"byteOffset", Kind::count},
    required({"byteLength", Kind::size}), required({"byteStride", Kind::size}),
    required({"count", Kind::size}),      required(word("mode", kMeshoptModes)),
    word("filter", kMeshoptFilters)};
constexpr Rule kBufferViewExtensions[] = {object(extension::kMeshopt, kMeshopt)};

constexpr int kTargets[] = {34962, 34963};
constexpr Rule kBufferView[] = {required({"buffer", Kind::index}),
                                {"byteOffset", Kind::count},
                                required({"byteLength", Kind::size}),
                                {"byteStride", Kind::stride},
                                code("target", kTargets),
                                object("extensions", kBufferViewExtensions)};

constexpr int kComponentTypes[] = {5120, 5121, 5122, 5123, 5125, 5126};
constexpr std::string_view kElementTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4",
                                              "MAT2",   "MAT3", "MAT4"};
constexpr Rule kSparseIndices[] = {required({"bufferView", Kind::index}),
                                   {"byteOffset", Kind::index},
                                   required(code("componentType", kComponentTypes))};
constexpr Rule kSparseValues[] = {required({"bufferView", Kind::index}),
                                  {"byteOffset", Kind::index}};
constexpr Rule kSparse[] = {required({"count", Kind::index}),
                            required(object("indices", kSparseIndices)),
                            required(object("values", kSparseValues))};
constexpr Rule kAccessor[] = {{"bufferView", Kind::index},
                              {"byteOffset", Kind::count},
                              required(code("componentType", kComponentTypes)),
                              required({"count", Kind::size}),
                              required(word("type", kElementTypes)),
                              {"normalized", Kind::boolean},
                              {"min", Kind::numbers},
                              {"max", Kind::numbers},
                              object("sparse", kSparse)};

constexpr Rule kImage[] = {
    {"uri", Kind::text}, {"bufferView", Kind::index}, {"mimeType", Kind::text}};

constexpr int kMagFilters[] = {9728, 9729};
constexpr int kMinFilters[] = {9728, 9729, 9984, 9985, 9986, 9987};
constexpr int kWraps[] = {33071, 33648, 10497};
constexpr Rule kSampler[] = {code("magFilter", kMagFilters), code("minFilter", kMinFilters),
                             code("wrapS", kWraps), code("wrapT", kWraps)};

constexpr Rule kWebp[] = {{"source", Kind::index}};
constexpr Rule kTextureExtensions[] = {object(extension::kWebp, kWebp)};
constexpr Rule kTexture[] = {
    {"sampler", Kind::index}, {"source", Kind::index}, object("extensions", kTextureExtensions)};

constexpr Rule kTextureTransform[] = {numbers("offset", 2),
                                      {"rotation", Kind::number},
                                      numbers("scale", 2),
                                      {"texCoord", Kind::index}};
constexpr Rule kTextureInfoExtensions[] = {object(extension::kTextureTransform, kTextureTransform)};
constexpr Rule kTextureInfo[] = {required({"index", Kind::index}),
                                 {"texCoord", Kind::index},
                                 {"scale", Kind::number},     // of normalTexture
                                 {"strength", Kind::number},  // of occlusionTexture
                                 object("extensions", kTextureInfoExtensions)};

constexpr std::string_view kAlphaModes[] = {"OPAQUE", "MASK", "BLEND"};
constexpr Rule kMetallicRoughness[] = {color("baseColorFactor", 4),
                                       object("baseColorTexture", kTextureInfo),
                                       {"metallicFactor", Kind::number},
                                       {"roughnessFactor", Kind::number},
                                       object("metallicRoughnessTexture", kTextureInfo)};
constexpr Rule kSpecularGlossiness[] = {color("diffuseFactor", 4),
                                        object("diffuseTexture", kTextureInfo)};
constexpr Rule kEmissiveStrength[] = {number("emissiveStrength", 0)};
constexpr Rule kMaterialExtensions[] = {object(extension::kSpecularGlossiness, kSpecularGlossiness),
                                        object(extension::kEmissiveStrength, kEmissiveStrength)};
constexpr Rule kMaterial[] = {
    word("alphaMode", kAlphaModes),           number("alphaCutoff", 0),
    {"doubleSided", Kind::boolean},           numbers("emissiveFactor", 3, -kRounding),
    object("emissiveTexture", kTextureInfo),  object("normalTexture", kTextureInfo),
    object("occlusionTexture", kTextureInfo), object("pbrMetallicRoughness", kMetallicRoughness),
    object("extensions", kMaterialExtensions)};

constexpr Rule kDraco[] = {required({"bufferView", Kind::index}),
                           required({"attributes", Kind::index_map})};
constexpr Rule kPrimitiveExtensions[] = {object(extension::kDraco, kDraco)};
constexpr int kModes[] = {0, 1, 2, 3, 4, 5, 6};
constexpr Rule kPrimitive[] = {required({"attributes", Kind::index_map}),
                               {"indices", Kind::index},
                               {"material", Kind::index},
                               code("mode", kModes),
                               {"targets", Kind::index_maps},
                               object("extensions", kPrimitiveExtensions)};
constexpr Rule kMesh[] = {required(objects("primitives", kPrimitive, "primitive", kMany)),
                          {"weights", Kind::numbers}};

constexpr Rule kSkin[] = {{"inverseBindMatrices", Kind::index},
                          {"skeleton", Kind::index},
                          required({"joints", Kind::indices})};

constexpr std::string_view kPaths[] = {"translation", "rotation", "scale", "weights", "pointer"};
constexpr std::string_view kInterpolations[] = {"LINEAR", "STEP", "CUBICSPLINE"};
constexpr Rule kChannelTarget[] = {{"node", Kind::index}, required(word("path", kPaths))};
constexpr Rule kChannel[] = {required({"sampler", Kind::index}),
                             required(object("target", kChannelTarget))};
constexpr Rule kAnimationSampler[] = {required({"input", Kind::index}),
                                      required({"output", Kind::index}),
                                      word("interpolation", kInterpolations)};
constexpr Rule kAnimation[] = {required(objects("channels", kChannel, "channel", kMany)),
                               required(objects("samplers", kAnimationSampler, "sampler", kMany))};

constexpr Rule kNodeLight[] = {required({"light", Kind::index})};
constexpr Rule kGpuInstancing[] = {required({"attributes", Kind::index_map})};
constexpr Rule kNodeExtensions[] = {object(extension::kLights, kNodeLight),
                                    object(extension::kInstancing, kGpuInstancing)};
constexpr Rule kNode[] = {{"mesh", Kind::index},      {"camera", Kind::index},
                          {"skin", Kind::index},      {"children", Kind::indices},
                          numbers("matrix", 16),      numbers("translation", 3),
                          numbers("rotation", 4),     numbers("scale", 3),
                          {"weights", Kind::numbers}, object("extensions", kNodeExtensions)};

constexpr std::string_view kCameraTypes[] = {"perspective", "orthographic"};
constexpr Rule kPerspective[] = {{"aspectRatio", Kind::positive},
                                 required({"yfov", Kind::number}),
                                 {"zfar", Kind::positive},
                                 required({"znear", Kind::positive})};
constexpr Rule kOrthographic[] = {required({"xmag", Kind::number}),
                                  required({"ymag", Kind::number}),
                                  required({"zfar", Kind::positive}), required(number("znear", 0))};
constexpr Rule kCamera[] = {required(word("type", kCameraTypes)),
                            object("perspective", kPerspective),
                            object("orthographic", kOrthographic)};

constexpr Rule kScene[] = {{"nodes", Kind::indices}};

constexpr std::string_view kLightTypes[] = {"directional", "point", "spot"};
constexpr Rule kSpot[] = {{"innerConeAngle", Kind::number}, {"outerConeAngle", Kind::number}};
constexpr Rule kLight[] = {required(word("type", kLightTypes)),
                           numbers("color", 3, 0),
                           number("intensity", 0),
                           {"range", Kind::positive},
                           object("spot", kSpot)};
constexpr Rule kLights[] = {required(objects("lights", kLight, "light", kFew))};
constexpr Rule kExtensions[] = {object(extension::kLights, kLights)};

constexpr Rule kRoot[] = {required(object("asset", kAsset)),
                          {"extensionsUsed", Kind::texts},
                          {"extensionsRequired", Kind::texts},
                          {"scene", Kind::index},
                          objects("buffers", kBuffer, "buffer", kMany),
                          objects("bufferViews", kBufferView, "bufferView", kMany),
                          objects("accessors", kAccessor, "accessor", kMany),
                          objects("images", kImage, "image", kFew),
                          objects("samplers", kSampler, "sampler", kFew),
                          objects("textures", kTexture, "texture", kFew),
                          objects("materials", kMaterial, "material", kFew),
                          objects("meshes", kMesh, "mesh", kMany),
                          objects("nodes", kNode, "node", kMany),
                          objects("cameras", kCamera, "camera", kFew),
                          objects("scenes", kScene, "scene", kFew),
                          objects("skins", kSkin, "skin", kFew),
                          objects("animations", kAnimation, "animation", kFew),
                          object("extensions", kExtensions)};

}  // namespace

Rules document_rules() { return kRoot; }

}  // namespace dapple::gltf
