// Collects the cases of the corpus and writes their files: see corpus.hpp.
#include "corpus/corpus.hpp"

namespace dapple::test {

namespace fs = std::filesystem;

std::string write_files(const SceneFiles& files, const fs::path& folder) {
  if (files.prepare) files.prepare(folder);
  for (const auto& [name, bytes] : files.files) {
    const fs::path file = folder / name;
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  return (folder / files.scene).string();
}

SceneFiles as_glb(const GltfBuilder& builder) {
  return {"scene.glb", {{"scene.glb", builder.glb()}}, {}};
}

SceneFiles as_gltf(const GltfBuilder& builder) {
  json document = builder.doc;
  document["buffers"] = json::array({{{"uri", "scene.bin"}, {"byteLength", builder.bin.size()}}});
  SceneFiles files = as_text(document.dump(2));
  files.files["scene.bin"] = builder.bin;
  return files;
}

SceneFiles as_text(const std::string& text) {
  return {"scene.gltf", {{"scene.gltf", Bytes(text.begin(), text.end())}}, {}};
}

MalformedCases malformed_corpus() {
  MalformedCases cases;
  add_malformed_containers(cases);
  add_malformed_json(cases);
  add_wrong_types(cases);
  add_wrong_values(cases);
  add_wrong_elements(cases);
  add_wrong_accessors(cases);
  add_malformed_files(cases);
  add_malformed_images(cases);
  add_wrong_motion(cases);
  add_malformed_hair(cases);
  add_bombs(cases);
  return cases;
}

TrickyCases tricky_corpus() {
  TrickyCases cases;
  add_tricky_geometry(cases);
  add_tricky_scenes(cases);
  add_tricky_materials(cases);
  add_tricky_files(cases);
  return cases;
}

}  // namespace dapple::test
