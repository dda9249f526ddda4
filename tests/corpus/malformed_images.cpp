// Images that the renderer needs for opacity, and that are cut off, corrupt, too large or in an
// unsupported format.
#include "corpus/corpus.hpp"

namespace dapple::test {
namespace {

/// A triangle whose material takes its alpha from texture 0.
GltfBuilder blended() {
  GltfBuilder builder = one_triangle();
  builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
  builder.doc["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      builder.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, kFloat, "VEC2");
  builder.doc["materials"] = {
      {{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  builder.add("textures", {{"source", 0}});
  return builder;
}

void add_bytes(MalformedCases& cases, const char* name, const Bytes& image, const char* says) {
  GltfBuilder builder = blended();
  builder.add("images", {{"bufferView", builder.add_view(image)}, {"mimeType", "image/png"}});
  cases.push_back({std::string("image_") + name, as_glb(builder), says});
}

Bytes first(const Bytes& bytes, std::size_t count) {
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count)};
}

Bytes changed(Bytes bytes, std::size_t at) {
  bytes[at] ^= 0x55;
  return bytes;
}

/// A JPEG file that begins with the headers of an image of 8 x 8 pixels and continues with `tail`.
/// `width_high` is the high byte of the width.
Bytes jpeg_of(std::uint8_t width_high, const Bytes& tail) {
  Bytes bytes = {0xff, 0xd8, 0xff, 0xc0, 0, 11, 8, 0, 8, width_high, 8, 1, 1, 0x11, 0};
  for (const std::uint8_t byte : tail) bytes.push_back(byte);
  return bytes;
}

void add_png(MalformedCases& cases) {
  const Bytes sound = png::with_alpha(8, 8, Bytes(64, 9));
  add_bytes(cases, "png_cut_in_its_signature", first(sound, 4), "image 0");
  add_bytes(cases, "png_of_a_signature", first(sound, 8), "is corrupt");
  add_bytes(cases, "png_cut_in_its_header", first(sound, 20), "is corrupt");
  add_bytes(cases, "png_cut_in_its_pixels", first(sound, 90), "is corrupt");
  add_bytes(cases, "png_without_its_end", first(sound, sound.size() - 12), "is corrupt");
  add_bytes(cases, "png_of_a_wrong_checksum", changed(sound, 60), "checksum is wrong");
  add_bytes(cases, "png_of_a_damaged_width", changed(sound, 18), "image 0");
  add_bytes(cases, "png_without_pixels", png::encode(8, 8, 8, 6, {}), "is corrupt");
  add_bytes(cases, "png_of_width_zero", png::encode(0, 8, 8, 6, {}), "is corrupt");
  add_bytes(cases, "png_of_height_zero", png::encode(8, 0, 8, 6, {}), "is corrupt");
  add_bytes(cases, "png_of_unknown_color", png::encode(8, 8, 8, 5, Bytes(64, 0)), "is corrupt");
  add_bytes(cases, "png_of_three_bits", png::encode(8, 8, 3, 0, Bytes(64, 0)), "is corrupt");
  add_bytes(cases, "png_of_few_rows", png::encode(8, 64, 8, 6, Bytes(64, 0)), "is corrupt");
  add_bytes(cases, "png_of_400_megapixels", png::encode(20000, 20000, 8, 6, {}), "is too large");
  add_bytes(cases, "png_of_2_gigapixels", png::encode(65535, 32768, 8, 0, {}), "is too large");
  add_bytes(cases, "png_of_31_bits", png::encode(0x7fffffffu, 0x7fffffffu, 8, 6, {}),
            "is too large");
  add_bytes(cases, "png_of_32_bits", png::encode(0xffffffffu, 0xffffffffu, 1, 0, {}),
            "is too large");
}

void add_jpeg(MalformedCases& cases) {
  add_bytes(cases, "jpeg_of_a_signature", {0xff, 0xd8, 0xff}, "is corrupt");
  add_bytes(cases, "jpeg_cut_in_a_segment", {0xff, 0xd8, 0xff, 0xe0, 0x40, 0, 1, 2}, "is corrupt");
  add_bytes(cases, "jpeg_without_pixels", jpeg_of(0, {0xff, 0xd9}), "is corrupt");
  add_bytes(cases, "jpeg_without_an_end", jpeg_of(0, {0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, 1, 2}),
            "is corrupt");
  // A Huffman table of sixteen lengths with 17 codes each, 272 in all. Fuzzing found this case.
  Bytes table = {0xff, 0xc4, 0x01, 0x23, 0};
  table.resize(table.size() + 16, 17);
  table.resize(2 + 0x123 + 2, 1);
  table.insert(table.end(), {0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, 1, 0xff, 0xd9});
  add_bytes(cases, "jpeg_of_272_codes", jpeg_of(0, table), "more than 255 codes");
  Bytes scans;
  for (int i = 0; i < 500; ++i) {
    const Bytes scan = {0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, 1};
    scans.insert(scans.end(), scan.begin(), scan.end());
  }
  scans.insert(scans.end(), {0xff, 0xd9});
  add_bytes(cases, "jpeg_of_500_scans", jpeg_of(0x20, scans), "scans");
}

void add_other_kinds(MalformedCases& cases) {
  const auto text = [](const std::string& bytes) { return Bytes(bytes.begin(), bytes.end()); };
  const char* const says = "is none of PNG, JPEG and WebP";
  add_bytes(cases, "empty_of_noise", Bytes(4, 0), says);
  add_bytes(cases, "gif", text("GIF89a\1\0\1\0\0\0\0;"), says);
  add_bytes(cases, "webp", text({"RIFF\x1a\0\0\0WEBPVP8L", 16}), "is corrupt (its WebP header)");
  add_bytes(cases, "ktx2", text("\xabKTX 20\xbb\r\n\x1a\n"), says);
  add_bytes(cases, "svg", text("<svg xmlns=\"http://www.w3.org/2000/svg\"/>"), says);
}

void add_sources(MalformedCases& cases) {
  const auto add = [&](const char* name, const json& image, const char* says) {
    GltfBuilder builder = blended();
    builder.add("images", image);
    cases.push_back({std::string("image_") + name, as_glb(builder), says});
  };
  add("absent", {{"uri", "absent.png"}}, "image 0 (absent.png)");
  add("outside", {{"uri", "../leaf.png"}}, "image 0: its uri \"../leaf.png\" leads out");
  add("far_away", {{"uri", "https://example.org/leaf.png"}}, "image 0");
  add("of_bad_base64", {{"uri", "data:image/png;base64,####"}}, "image 0");
  add("of_empty_data", {{"uri", "data:image/png;base64,"}}, "image 0");
  add("of_nothing", json::object(), "image 0: has neither a uri nor a bufferView");
  add("of_both", {{"uri", "a.png"}, {"bufferView", 0}}, "image 0: has both");
  add("of_an_unknown_view", {{"bufferView", 9}, {"mimeType", "image/png"}},
      "image 0 names bufferView 9");
  GltfBuilder avif = blended();
  avif.add("images", {{"uri", "leaf.avif"}});
  avif.doc["textures"][0] = {{"extensions", {{"EXT_texture_avif", {{"source", 0}}}}}};
  cases.push_back({"image_of_avif_alone", as_glb(avif), "exists only as EXT_texture_avif"});
  GltfBuilder webp = blended();
  webp.doc["textures"][0] = {{"extensions", {{"EXT_texture_webp", {{"source", 5}}}}}};
  cases.push_back({"image_of_webp_that_is_absent", as_glb(webp), "texture 0 names image 5"});
  GltfBuilder none = blended();
  none.doc["textures"][0] = json::object();
  cases.push_back({"image_of_no_source", as_glb(none), "texture 0 of material 0 has no image"});
}

}  // namespace

void add_malformed_images(MalformedCases& cases) {
  add_png(cases);
  add_jpeg(cases);
  add_other_kinds(cases);
  add_sources(cases);
}

}  // namespace dapple::test
