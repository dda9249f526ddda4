// Builds the scene element by element: see sound_scene.hpp.
#include "corpus/sound_scene.hpp"

namespace dapple::test {
namespace {

/// Mesh 0: a card of two triangles that face +Z, with material 0.
void add_card(GltfBuilder& b) {
  const int position = b.add_positions({-1, 0, 0, 1, 0, 0, 1, 2, 0, -1, 2, 0});
  b.doc["accessors"][position]["min"] = {-1, 0, 0};
  b.doc["accessors"][position]["max"] = {1, 2, 0};
  const int normal = b.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int uv = b.add_accessor(std::vector<float>{0, 1, 1, 1, 1, 0, 0, 0}, kFloat, "VEC2");
  const int color = b.add_accessor(
      std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 255},
      kUint8, "VEC4", true);
  const int indices =
      b.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, kUint16, "SCALAR");
  b.doc["bufferViews"][position]["target"] = 34962;
  b.doc["bufferViews"][position]["byteStride"] = 12;
  b.add("meshes",
        {{"name", "card"},
         {"weights", {0.0}},
         {"primitives", json::array({{{"attributes",
                                       {{"POSITION", position},
                                        {"NORMAL", normal},
                                        {"TEXCOORD_0", uv},
                                        {"COLOR_0", color}}},
                                      {"indices", indices},
                                      {"material", 0},
                                      {"mode", 4},
                                      {"targets", json::array({{{"POSITION", normal}}})}}})}});
}

/// Mesh 1: a fan in the plane y = 0 with material 1. Sparse values replace its last corner.
void add_ground(GltfBuilder& b) {
  const int position = b.add_positions({-4, 0, 4, 4, 0, 4, 4, 0, -4, 0, 0, 0});
  const int at = b.add_view(pack<std::uint16_t>({3}));
  const int values = b.add_view(pack<float>({-4, 0, -4}));
  b.doc["accessors"][position]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", at}, {"byteOffset", 0}, {"componentType", kUint16}}},
      {"values", {{"bufferView", values}, {"byteOffset", 0}}}};
  b.add(
      "meshes",
      {{"name", "ground"},
       {"primitives",
        json::array({{{"attributes", {{"POSITION", position}}}, {"material", 1}, {"mode", 6}}})}});
}

void add_materials(GltfBuilder& b) {
  const int view = b.add_view(png::with_alpha(2, 2, {255, 60, 60, 255}));
  b.add("images", {{"bufferView", view}, {"mimeType", "image/png"}, {"name", "leaf.png"}});
  b.add("samplers", {{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 10497}, {"wrapT", 33071}});
  b.add("textures", {{"source", 0}, {"sampler", 0}});
  const json texture = {{"index", 0}, {"texCoord", 0}};
  json base = texture;
  base["extensions"]["KHR_texture_transform"] = {
      {"offset", {0, 0}}, {"rotation", 0}, {"scale", {1, 1}}, {"texCoord", 0}};
  json normal = texture, occlusion = texture;
  normal["scale"] = 1.0;
  occlusion["strength"] = 1.0;
  b.add("materials", {{"name", "leaf"},
                      {"alphaMode", "BLEND"},
                      {"doubleSided", true},
                      {"emissiveFactor", {0, 0, 0}},
                      {"emissiveTexture", texture},
                      {"normalTexture", normal},
                      {"occlusionTexture", occlusion},
                      {"pbrMetallicRoughness",
                       {{"baseColorFactor", {1, 1, 1, 0.75}},
                        {"baseColorTexture", base},
                        {"metallicRoughnessTexture", texture},
                        {"metallicFactor", 0.0},
                        {"roughnessFactor", 0.5}}}});
  b.add("materials", {{"name", "earth"}, {"alphaMode", "MASK"}, {"alphaCutoff", 0.5}});
}

void add_nodes(GltfBuilder& b) {
  b.add("cameras",
        {{"type", "perspective"},
         {"perspective", {{"yfov", 0.8}, {"znear", 0.1}, {"zfar", 100.0}, {"aspectRatio", 1.5}}}});
  b.add("cameras",
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 3.0}, {"ymag", 2.0}, {"znear", 0.0}, {"zfar", 100.0}}}});
  b.doc["extensionsUsed"] = {"KHR_lights_punctual", "KHR_texture_transform"};
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"},
       {"color", {1, 1, 1}},
       {"intensity", 20.0},
       {"range", 50.0},
       {"spot", {{"innerConeAngle", 0.3}, {"outerConeAngle", 0.9}}}}};
  b.add("nodes", {{"name", "root"}, {"children", {1, 2, 3, 4, 5}}});
  b.add("nodes", {{"mesh", 0},
                  {"skin", 0},
                  {"weights", {0.0}},
                  {"translation", {0, 0.5, 0}},
                  {"rotation", {0, 0, 0, 1}},
                  {"scale", {1, 1, 1}}});
  b.add("nodes", {{"mesh", 1}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
  b.add("nodes", {{"camera", 0}, {"translation", {0, 1.5, 6}}});
  b.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}},
                  {"translation", {0, 5, 1}},
                  {"rotation", {-0.7071068, 0, 0, 0.7071068}}});
  b.add("nodes", {{"name", "joint"}, {"camera", 1}, {"translation", {0, 0.5, 0}}});
  b.add("scenes", {{"name", "all"}, {"nodes", {0}}});
  b.doc["scene"] = 0;
}

void add_motion(GltfBuilder& b) {
  const int matrix = b.add_view(pack<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5, 0, 1}));
  const int bind = b.add("accessors", {{"bufferView", matrix},
                                       {"byteOffset", 0},
                                       {"componentType", kFloat},
                                       {"count", 1},
                                       {"type", "MAT4"}});
  b.add("skins", {{"joints", {5}}, {"inverseBindMatrices", bind}, {"skeleton", 5}});
  const int times = b.add_accessor(std::vector<float>{0, 1}, kFloat, "SCALAR");
  const int places = b.add_positions({0, 0, 0, 1, 1, 1});
  b.add("animations",
        {{"samplers",
          json::array({{{"input", times}, {"output", places}, {"interpolation", "LINEAR"}}})},
         {"channels",
          json::array({{{"sampler", 0}, {"target", {{"node", 5}, {"path", "translation"}}}}})}});
}

}  // namespace

GltfBuilder sound_scene() {
  GltfBuilder builder;
  builder.doc["asset"] = {{"version", "2.0"}, {"generator", "corpus"}, {"copyright", "none"}};
  add_card(builder);
  add_ground(builder);
  add_materials(builder);
  add_nodes(builder);
  add_motion(builder);
  builder.doc["buffers"] = json::array({{{"byteLength", builder.bin.size()}}});
  return builder;
}

}  // namespace dapple::test
