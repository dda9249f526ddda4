// The properties of glTF 2.0 and its extensions that dapple reads, bottom up: see
// schema_rules.hpp.
#include "scene/gltf/schema_rules.hpp"

namespace dapple::gltf {
namespace {

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
                                   required("componentType", Kind::component_type)};
constexpr Rule kSparseValues[] = {required("bufferView", Kind::index), {"byteOffset", Kind::index}};
constexpr Rule kSparse[] = {required("count", Kind::index),
                            required("indices", Kind::object, kSparseIndices),
                            required("values", Kind::object, kSparseValues)};
constexpr Rule kAccessor[] = {{"bufferView", Kind::index},
                              {"byteOffset", Kind::count},
                              required("componentType", Kind::component_type),
                              required("count", Kind::count),
                              required("type", Kind::element_type),
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
                            required("type", Kind::camera_type),
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

}  // namespace

Rules document_rules() { return kRoot; }

}  // namespace dapple::gltf
