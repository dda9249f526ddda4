// The same opacity of the card in all the ways in which glTF can store one.
#include "corpus/stage.hpp"

namespace dapple::test {
namespace {

constexpr std::uint8_t kAlpha = 102;
constexpr double kOpacity = kAlpha / 255.0;  // 0.4

GltfBuilder with_material(const json& material) {
  GltfBuilder builder = plain_stage();
  builder.doc["materials"] = json::array({material});  // for clang, {material} is a copy
  builder.doc["meshes"][1]["primitives"][0]["material"] = 0;
  return builder;
}

json& attributes(GltfBuilder& builder) {
  return builder.doc["meshes"][1]["primitives"][0]["attributes"];
}

json factor(double alpha) { return {{"baseColorFactor", {0.2, 0.9, 0.1, alpha}}}; }

/// Adds a case whose twin has the alphaMode BLEND and the opacity kOpacity as a factor.
void add(TrickyCases& cases, const char* name, const GltfBuilder& builder) {
  const json plain = {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", factor(kOpacity)}};
  cases.push_back({name, as_glb(builder), as_glb(with_material(plain))});
}

/// Adds a case whose twin has no material, and is opaque.
void add_opaque(TrickyCases& cases, const char* name, const GltfBuilder& builder) {
  cases.push_back({name, as_glb(builder), as_glb(plain_stage())});
}

GltfBuilder textured(const json& image, const char* uv_name = "TEXCOORD_0") {
  GltfBuilder builder = with_material(
      {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  attributes(builder)[uv_name] =
      builder.add_accessor(std::vector<float>{0, 1, 1, 1, 1, 0, 0, 1, 1, 0, 0, 0}, kFloat, "VEC2");
  builder.add("textures", {{"source", 0}});
  builder.add("images", image);
  return builder;
}

GltfBuilder textured_by(const Bytes& image) {
  GltfBuilder builder = textured({{"mimeType", "image/png"}});
  builder.doc["images"][0]["bufferView"] = builder.add_view(image);
  return builder;
}

Bytes even_png(std::uint32_t size) {
  return png::with_alpha(size, size, Bytes(std::size_t{size} * size, kAlpha));
}

void add_colors(TrickyCases& cases) {
  const auto colored = [](const auto& values, int component, bool normalized) {
    GltfBuilder builder = with_material({{"alphaMode", "BLEND"}});
    attributes(builder)["COLOR_0"] = builder.add_accessor(values, component, "VEC4", normalized);
    return builder;
  };
  std::vector<float> floats;
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;
  for (int i = 0; i < 6; ++i) {
    floats.insert(floats.end(), {1, 0, 1, float(kOpacity)});
    bytes.insert(bytes.end(), {255, 0, 255, kAlpha});
    words.insert(words.end(), {65535, 0, 65535, kAlpha * 257});
  }
  add(cases, "opacity_by_float_colors", colored(floats, kFloat, false));
  add(cases, "opacity_by_u8_colors", colored(bytes, kUint8, true));
  add(cases, "opacity_by_u16_colors", colored(words, kUint16, true));
}

void add_textures(TrickyCases& cases) {
  add(cases, "opacity_by_a_texture", textured_by(even_png(4)));
  add(cases, "opacity_by_one_texel", textured_by(even_png(1)));
  Bytes grey;
  for (int i = 0; i < 4; ++i) grey.insert(grey.end(), {7, kAlpha});
  add(cases, "opacity_by_a_grey_texture", textured_by(png::encode(2, 2, 8, 4, grey)));
  Bytes wide;
  for (int i = 0; i < 4; ++i) wide.insert(wide.end(), {1, 2, 3, 4, 5, 6, kAlpha, kAlpha});
  add(cases, "opacity_by_a_16_bit_texture", textured_by(png::encode(2, 2, 16, 6, wide)));
  GltfBuilder second = textured({{"mimeType", "image/png"}}, "TEXCOORD_1");
  second.doc["images"][0]["bufferView"] = second.add_view(even_png(2));
  second.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1;
  add(cases, "opacity_by_the_second_texcoord", second);
  GltfBuilder moved = textured_by(even_png(2));
  moved.doc["extensionsUsed"] = {"KHR_texture_transform"};
  moved.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
      {"KHR_texture_transform",
       {{"offset", {3.5, -7}}, {"rotation", 1.2}, {"scale", {-40, 0.001}}}}};
  add(cases, "opacity_by_a_moved_texture", moved);
  GltfBuilder misnamed = textured_by(even_png(2));
  misnamed.doc["images"][0]["mimeType"] = "image/jpeg";
  add(cases, "opacity_by_a_misnamed_texture", misnamed);
  GltfBuilder unnamed = textured_by(even_png(2));
  unnamed.doc["images"][0].erase("mimeType");
  add(cases, "opacity_by_a_nameless_texture", unnamed);
  GltfBuilder sampled = textured_by(even_png(3));
  sampled.add("samplers",
              {{"magFilter", 9728}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33648}});
  sampled.doc["textures"][0]["sampler"] = 0;
  add(cases, "opacity_by_a_sampler", sampled);
}

void add_modes(TrickyCases& cases) {
  GltfBuilder gloss = with_material({{"alphaMode", "BLEND"}});
  gloss.doc["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
  gloss.doc["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"diffuseFactor", {1, 1, 1, kOpacity}}};
  add(cases, "opacity_by_gloss", gloss);
  GltfBuilder unlit = with_material({{"alphaMode", "BLEND"},
                                     {"pbrMetallicRoughness", factor(kOpacity)},
                                     {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  unlit.doc["extensionsUsed"] = {"KHR_materials_unlit"};
  add(cases, "opacity_unlit", unlit);
  add_opaque(cases, "opaque_despite_its_alpha",
             with_material({{"pbrMetallicRoughness", factor(0)}}));
  add_opaque(cases, "masked_above_its_cutoff",
             with_material({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", factor(0.6)}}));
  add_opaque(
      cases, "masked_at_cutoff_zero",
      with_material(
          {{"alphaMode", "MASK"}, {"alphaCutoff", 0}, {"pbrMetallicRoughness", factor(0.1)}}));
  // The twin has an invisible card, too: the light's position depends on its bounds.
  cases.push_back(
      {"masked_below_its_cutoff",
       as_glb(with_material({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", factor(0.4)}})),
       as_glb(with_material({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", factor(0)}}))});
  GltfBuilder lost =
      with_material({{"normalTexture", {{"index", 0}}},
                     {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  lost.add("textures", {{"source", 0}});
  lost.add("images", {{"uri", "lost.png"}});
  add_opaque(cases, "a_lost_image_that_does_not_matter", lost);
}

}  // namespace

void add_tricky_materials(TrickyCases& cases) {
  add_colors(cases);
  add_textures(cases);
  add_modes(cases);
}

}  // namespace dapple::test
