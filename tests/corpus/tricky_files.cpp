// The plain stage in files with unusual names, URIs, padding and encodings.
#include <algorithm>

#include "corpus/stage.hpp"

namespace dapple::test {
namespace {

namespace fs = std::filesystem;

void add(TrickyCases& cases, const char* name, const SceneFiles& files) {
  cases.push_back({std::string("file_") + name, files, as_glb(plain_stage())});
}

std::string base64(const Bytes& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= count ? kDigits[(bits >> (18 - 6 * k)) & 63u] : '=';
  }
  return text;
}

std::string escape(std::uint8_t byte) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  return {'%', kDigits[byte >> 4], kDigits[byte & 15u]};
}

std::string data_uri(const std::string& head, const std::string& data) {
  return "data:" + head + "," + data;
}

/// scene.gltf whose buffer has the URI `uri`. The buffer is in the file `name`, unless that is
/// empty.
SceneFiles at_uri(const std::string& uri, const std::string& name) {
  const GltfBuilder stage = plain_stage();
  json document = stage.doc;
  document["buffers"] = json::array({{{"uri", uri}, {"byteLength", stage.bin.size()}}});
  SceneFiles files = as_text(document.dump());
  if (!name.empty()) files.files[name] = stage.bin;
  return files;
}

void add_uris(TrickyCases& cases) {
  add(cases, "beside", at_uri("scene.bin", "scene.bin"));
  add(cases, "with_spaces", at_uri("my%20scene%20data.bin", "my scene data.bin"));
  add(cases, "with_raw_spaces", at_uri("my scene data.bin", "my scene data.bin"));
  add(cases, "in_unicode",
      at_uri("b\xc3\xa4ume \xf0\x9f\x8c\xb3.bin", "b\xc3\xa4ume \xf0\x9f\x8c\xb3.bin"));
  add(cases, "in_encoded_unicode", at_uri("b%C3%A4ume.bin", "b\xc3\xa4ume.bin"));
  add(cases, "in_lower_case_escapes", at_uri("b%c3%a4ume.bin", "b\xc3\xa4ume.bin"));
  add(cases, "of_a_percent_sign", at_uri("100%.bin", "100%.bin"));
  add(cases, "in_a_folder", at_uri("data/scene.bin", "data/scene.bin"));
  add(cases, "with_a_dot", at_uri("./scene.bin", "scene.bin"));
  add(cases, "by_a_detour", at_uri("data/../scene.bin", "scene.bin"));
  cases.back().files.files["data/other.bin"] = {};
  SceneFiles linked = at_uri("link.bin", "scene.bin");
  linked.prepare = [](const fs::path& folder) {
    fs::create_symlink("scene.bin", folder / "link.bin");
  };
  add(cases, "by_a_link", linked);
  const std::string data = base64(plain_stage().bin);
  add(cases, "as_octets", at_uri(data_uri("application/octet-stream;base64", data), ""));
  add(cases, "as_a_gltf_buffer", at_uri(data_uri("application/gltf-buffer;base64", data), ""));
  add(cases, "as_data_of_no_type", at_uri(data_uri(";base64", data), ""));
  add(cases, "as_data_without_padding",
      at_uri(data_uri("application/octet-stream;base64", data.substr(0, data.find('='))), ""));
  std::string escapes;
  for (const std::uint8_t byte : plain_stage().bin) escapes += escape(byte);
  add(cases, "as_escapes", at_uri(data_uri("application/octet-stream", escapes), ""));
}

void add_texts(TrickyCases& cases) {
  const auto text = [](const std::function<void(std::string&)>& edit) {
    SceneFiles files = as_gltf(plain_stage());
    Bytes& bytes = files.files["scene.gltf"];
    std::string document(bytes.begin(), bytes.end());
    edit(document);
    bytes = Bytes(document.begin(), document.end());
    return files;
  };
  add(cases, "of_crlf", text([](std::string& document) {
        for (std::size_t at = 0; (at = document.find('\n', at)) != std::string::npos; at += 2)
          document.insert(at, "\r");
      }));
  add(cases, "of_tabs", text([](std::string& document) {
        std::replace(document.begin(), document.end(), ' ', '\t');
      }));
  add(cases, "of_a_bom", text([](std::string& d) { d.insert(0, "\xef\xbb\xbf"); }));
  add(cases, "of_blank_lines", text([](std::string& d) { d.insert(0, "\n\n ").append("\n \n"); }));
}

void set_length(Bytes& glb) {
  for (std::size_t i = 0; i < 4; ++i) glb[8 + i] = static_cast<std::uint8_t>(glb.size() >> (8 * i));
}

void add_containers(TrickyCases& cases) {
  const Bytes sound = plain_stage().glb();
  const auto glb = [](const Bytes& bytes) {
    return SceneFiles{"scene.glb", {{"scene.glb", bytes}}, {}};
  };
  Bytes padded = sound;
  padded.resize(padded.size() + 512, 0);
  add(cases, "of_zeros_behind", glb(padded));
  Bytes chunk = sound;
  for (const std::uint32_t word : {8u, 0x58585858u, 1u, 2u}) append(chunk, word);
  set_length(chunk);
  add(cases, "of_an_unknown_chunk", glb(chunk));
  Bytes empty = sound;
  for (const std::uint32_t word : {0u, 0x58585858u}) append(empty, word);
  set_length(empty);
  add(cases, "of_an_empty_chunk", glb(empty));
  Bytes nuls = sound;
  std::replace(nuls.begin() + 20, nuls.begin() + 20 + nuls[12] + 256 * nuls[13], std::uint8_t{' '},
               std::uint8_t{0});
  add(cases, "of_nul_padding", glb(nuls));
  GltfBuilder longer = plain_stage();
  longer.doc["buffers"] = json::array({{{"byteLength", longer.bin.size()}}});
  longer.bin.resize(longer.bin.size() + 3, 0);
  add(cases, "of_a_longer_chunk", as_glb(longer));
  SceneFiles outside = as_gltf(plain_stage());
  outside.files["scene.bin"].resize(outside.files["scene.bin"].size() + 100, 1);
  add(cases, "of_a_longer_buffer", outside);
  add(cases, "named_otherwise", {"scene.gltf", {{"scene.gltf", sound}}, {}});
  SceneFiles text = as_gltf(plain_stage());
  text.files["tree.glb"] = text.files["scene.gltf"];
  text.scene = "tree.glb";
  add(cases, "of_text_named_glb", text);
  SceneFiles link{"link.glb", {{"data/scene.glb", sound}}, [](const fs::path& folder) {
                    fs::create_symlink("data/scene.glb", folder / "link.glb");
                  }};
  add(cases, "that_is_a_link", link);
}

void add_buffers(TrickyCases& cases) {
  const GltfBuilder stage = plain_stage();
  SceneFiles twice = as_gltf(stage);
  json document = stage.doc;
  const json buffer = {{"uri", "scene.bin"}, {"byteLength", stage.bin.size()}};
  document["buffers"] = json::array({buffer, buffer});
  document["bufferViews"][1]["buffer"] = 1;
  const std::string text = document.dump();
  twice.files["scene.gltf"] = Bytes(text.begin(), text.end());
  add(cases, "read_as_two_buffers", twice);
}

}  // namespace

void add_tricky_files(TrickyCases& cases) {
  add_uris(cases);
  add_texts(cases);
  add_containers(cases);
  add_buffers(cases);
}

}  // namespace dapple::test
