// The GLB writer: chunks and JSON follow the glTF 2.0 specification and hold the scene's triangles,
// materials, instances and cameras. The same scene gives the same bytes, and a failed write leaves
// no file.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/corner_normals.hpp"

namespace dapple {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

std::size_t smooth_triangles(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t)
      count += corner_normals(mesh, t).has_value();
  }
  return count;
}

// A temporary folder that the destructor removes.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("dapple_glb_" + std::to_string(getpid()))) {
    fs::remove_all(path_);
    fs::create_directory(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::ptrdiff_t count() const {
    return std::distance(fs::directory_iterator(path_), fs::directory_iterator());
  }

 private:
  fs::path path_;
};

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::uint32_t word_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, 4);
  return word;
}

struct Glb {
  Json json;
  std::string binary;
};

// Splits a GLB into its JSON and its binary chunk, and checks every length.
Glb take_apart(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word_at(bytes, 4), 2u);
  EXPECT_EQ(word_at(bytes, 8), bytes.size());
  const std::size_t json_length = word_at(bytes, 12);
  EXPECT_EQ(json_length % 4, 0u);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  const std::size_t after_json = 20 + json_length;
  Glb glb{Json::parse(bytes.substr(20, json_length)), ""};
  if (after_json == bytes.size()) return glb;
  EXPECT_EQ(word_at(bytes, after_json) % 4, 0u);
  EXPECT_EQ(bytes.substr(after_json + 4, 4), std::string("BIN\0", 4));
  glb.binary = bytes.substr(after_json + 8);
  EXPECT_EQ(glb.binary.size(), word_at(bytes, after_json));
  EXPECT_EQ(glb.json["buffers"][0]["byteLength"], glb.binary.size());
  return glb;
}

Glb write_and_take_apart(const Scene& scene) {
  const Folder folder;
  write_glb(scene, folder.file("scene.glb"));
  return take_apart(read_bytes(folder.file("scene.glb")));
}

template <typename T>
std::vector<T> accessor_values(const Glb& glb, std::size_t accessor) {
  const Json& description = glb.json["accessors"][accessor];
  const Json& view = glb.json["bufferViews"][description["bufferView"].get<std::size_t>()];
  std::vector<T> values(description["count"].get<std::size_t>());
  EXPECT_EQ(view["byteLength"], values.size() * sizeof(T));
  std::memcpy(static_cast<void*>(values.data()),
              glb.binary.data() + view["byteOffset"].get<std::size_t>(), values.size() * sizeof(T));
  return values;
}

Material material(const std::string& name, AlphaMode mode, float alpha) {
  Material result;
  result.name = name;
  result.alpha_mode = mode;
  result.alpha = alpha;
  return result;
}

// Two triangles of two materials, with two instances, and a camera. A third material is unused.
Scene small_scene() {
  Scene scene;
  scene.source = "small";
  scene.materials = {material("leaf", AlphaMode::blend, 0.25f),
                     material("bark", AlphaMode::opaque, 1), material("net", AlphaMode::mask, 1)};
  scene.materials[2].alpha_cutoff = 0.75f;
  Mesh mesh;
  mesh.name = "pair";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, -3}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.materials = {1, 0};
  scene.meshes = {mesh};
  Instance moved;
  moved.to_world = M44f(0, 0, -2, 0, 0, 2, 0, 0, 2, 0, 0, 0, 5, 6, 7, 1);
  scene.instances = {Instance{}, moved};
  scene.cameras = {look_at({0, 1, 5}, {0, 1, 0}, {0, 1, 0}, 0.5f)};
  scene.cameras[0].name = "front";
  return scene;
}

TEST(GlbWriter, ChunksAreAlignedAndAsLongAsTheySay) {
  const Glb glb = write_and_take_apart(small_scene());
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  EXPECT_EQ(glb.json["scene"], 0);
  EXPECT_EQ(glb.json["scenes"][0]["nodes"], Json({0, 1, 2}));
}

TEST(GlbWriter, EachMaterialOfAMeshIsOnePrimitiveOverTheSamePositions) {
  const Scene scene = small_scene();
  const Glb glb = write_and_take_apart(scene);
  const Json& primitives = glb.json["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_EQ(primitives[0]["material"], 0);
  EXPECT_EQ(primitives[1]["material"], 1);
  EXPECT_EQ(accessor_values<std::uint32_t>(glb, primitives[0]["indices"]),
            (std::vector<std::uint32_t>{0, 2, 3}));
  EXPECT_EQ(accessor_values<std::uint32_t>(glb, primitives[1]["indices"]),
            (std::vector<std::uint32_t>{0, 1, 2}));
  const std::size_t positions = primitives[0]["attributes"]["POSITION"];
  EXPECT_EQ(primitives[1]["attributes"]["POSITION"], positions);
  EXPECT_EQ(accessor_values<V3f>(glb, positions), scene.meshes[0].positions);
  EXPECT_EQ(glb.json["accessors"][positions]["min"], Json({0.0, 0.0, -3.0}));
  EXPECT_EQ(glb.json["accessors"][positions]["max"], Json({1.0, 2.0, 0.0}));
}

TEST(GlbWriter, TrianglesWithNormalsAreAPrimitiveWithVerticesOfItsOwn) {
  Scene scene = small_scene();
  Mesh& mesh = scene.meshes[0];
  mesh.materials = {1, 1};
  mesh.normals = {{0, 1, 0}, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}};  // the first triangle lacks one
  const Glb glb = write_and_take_apart(scene);
  const Json& primitives = glb.json["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_EQ(primitives[1]["material"], 1);
  EXPECT_FALSE(primitives[0]["attributes"].contains("NORMAL"));
  EXPECT_EQ(accessor_values<V3f>(glb, primitives[0]["attributes"]["POSITION"]), mesh.positions);
  const Json& smooth = primitives[1]["attributes"];
  EXPECT_EQ(accessor_values<std::uint32_t>(glb, primitives[1]["indices"]),
            (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(accessor_values<V3f>(glb, smooth["POSITION"]),
            (std::vector<V3f>{mesh.positions[0], mesh.positions[2], mesh.positions[3]}));
  EXPECT_EQ(accessor_values<V3f>(glb, smooth["NORMAL"]),
            (std::vector<V3f>{mesh.normals[0], mesh.normals[2], mesh.normals[3]}));
}

TEST(GlbWriter, MaterialsCarryTheirAlpha) {
  const Json materials = write_and_take_apart(small_scene()).json["materials"];
  EXPECT_EQ(materials[0]["alphaMode"], "BLEND");
  EXPECT_EQ(materials[0]["pbrMetallicRoughness"]["baseColorFactor"][3], 0.25);
  EXPECT_FALSE(materials[1].contains("alphaMode"));  // OPAQUE is glTF's default
  EXPECT_EQ(materials[2]["alphaMode"], "MASK");
  EXPECT_EQ(materials[2]["alphaCutoff"], 0.75);
}

TEST(GlbWriter, InstancesAndCamerasAreNodesWithMatrices) {
  const Json json = write_and_take_apart(small_scene()).json;
  EXPECT_FALSE(json["nodes"][0].contains("matrix"));
  // Column-major for column vectors: the translation comes last, as with our row vectors.
  EXPECT_EQ(json["nodes"][1]["matrix"], Json({0.0, 0.0, -2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0,
                                              0.0, 0.0, 5.0, 6.0, 7.0, 1.0}));
  EXPECT_EQ(json["nodes"][2]["camera"], 0);
  EXPECT_EQ(json["cameras"][0]["name"], "front");
  EXPECT_EQ(json["cameras"][0]["perspective"]["yfov"], 0.5);
}

TEST(GlbWriter, NodesHaveTheNamesThatTheyWereReadWith) {
  Scene scene = small_scene();
  scene.node_names = {"", "lamp"};
  scene.instances[0].node = 1;
  scene.instances[1].node = 0;
  const Json nodes = write_and_take_apart(scene).json["nodes"];
  EXPECT_EQ(nodes[0]["name"], "lamp");
  EXPECT_EQ(nodes[1]["name"], "pair") << "that of the mesh";
}

TEST(GlbWriter, VertexAlphaBecomesColoursOnlyWhereTheMaterialUsesIt) {
  Scene scene = small_scene();
  scene.meshes[0].vertex_alpha = {1, 0.5f, 0.25f, 0};
  scene.materials[1].uses_vertex_alpha = false;
  const Glb glb = write_and_take_apart(scene);
  const Json& primitives = glb.json["meshes"][0]["primitives"];
  EXPECT_FALSE(primitives[1]["attributes"].contains("COLOR_0"));
  const auto colours =
      accessor_values<Imath::V4f>(glb, primitives[0]["attributes"]["COLOR_0"].get<std::size_t>());
  EXPECT_EQ(colours.at(2), Imath::V4f(1, 1, 1, 0.25f));
}

TEST(GlbWriter, ColoursOfVerticesAreReadBackWhetherTheMaterialUsesTheirAlphaOrNot) {
  Scene scene = small_scene();
  scene.meshes[0].colors = {{1, 0, 0}, {0, 0.5f, 0}, {0.1f, 0.2f, 0.3f}, {1, 1, 1}};
  scene.meshes[0].vertex_alpha = {1, 0.5f, 0.25f, 0};
  scene.materials[1].uses_vertex_alpha = false;
  const Glb glb = write_and_take_apart(scene);
  const float alphas[2] = {0.25f, 1};
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& attributes = glb.json["meshes"][0]["primitives"][i]["attributes"];
    const auto colours = accessor_values<Imath::V4f>(glb, attributes["COLOR_0"].get<std::size_t>());
    EXPECT_EQ(colours.at(2), Imath::V4f(0.1f, 0.2f, 0.3f, alphas[i]));
  }
}

TEST(GlbWriter, ALensIsWrittenAsExtrasOfItsCamera) {
  Scene scene = small_scene();
  scene.cameras.assign(1, look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.5f));
  EXPECT_FALSE(write_and_take_apart(scene).json["cameras"][0].contains("extras"));
  scene.cameras[0].lens_radius = 0.25f;
  scene.cameras[0].focus_distance = 2.5f;
  const Json extras = write_and_take_apart(scene).json["cameras"][0]["extras"];
  EXPECT_EQ(extras["dapple_aperture"], 0.25);
  EXPECT_EQ(extras["dapple_focus_distance"], 2.5);
}

TEST(GlbWriter, EmissionAboveOneNeedsTheStrengthExtension) {
  Scene scene = small_scene();
  scene.materials[0].emission = {2, 8, 4};
  const Json dark = write_and_take_apart(scene).json;
  EXPECT_FALSE(dark["materials"][0].contains("emissiveFactor")) << "no instance emits";
  EXPECT_FALSE(dark.contains("extensionsUsed"));
  scene.lights.resize(1);
  scene.instances[0].light = 0;
  const Json json = write_and_take_apart(scene).json;
  EXPECT_EQ(json["materials"][0]["emissiveFactor"], Json({0.25, 1.0, 0.5}));
  EXPECT_EQ(
      json["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"],
      8.0);
  EXPECT_EQ(json["extensionsUsed"], Json({"KHR_materials_emissive_strength"}));
}

TEST(GlbWriter, AMeshWithoutTrianglesIsLeftOutAndTheOthersKeepTheirPlacements) {
  Scene scene = small_scene();
  scene.meshes.insert(scene.meshes.begin(), Mesh{});
  for (Instance& instance : scene.instances) instance.mesh = 1;
  scene.instances.push_back({});
  const Json json = write_and_take_apart(scene).json;
  EXPECT_EQ(json["meshes"].size(), 1u);
  EXPECT_EQ(json["nodes"].size(), 3u);
  EXPECT_EQ(json["nodes"][1]["mesh"], 0);
}

TEST(GlbWriter, AnEmptySceneIsStillAGlbFile) {
  const Glb glb = write_and_take_apart(Scene{});
  EXPECT_EQ(glb.json["scenes"].size(), 1u);
  EXPECT_TRUE(glb.binary.empty());
}

TEST(GlbWriter, TheSameSceneGivesTheSameBytes) {
  const Folder folder;
  const std::string name = "scene:forest?trees=4&leaves=50";
  write_glb(make_procedural(name), folder.file("a.glb"));
  write_glb(make_procedural(name), folder.file("b.glb"));
  EXPECT_EQ(read_bytes(folder.file("a.glb")), read_bytes(folder.file("b.glb")));
}

TEST(GlbWriter, WhatWasWrittenIsReadBack) {
  const Folder folder;
  const Scene scene = make_procedural("scene:demo");
  write_glb(scene, folder.file("demo.glb"));
  const Scene read = load_scene(folder.file("demo.glb"));
  std::size_t triangles = 0, read_triangles = 0;
  for (const Instance& i : scene.instances) triangles += scene.meshes[i.mesh].primitive_count();
  for (const Instance& i : read.instances) read_triangles += read.meshes[i.mesh].primitive_count();
  EXPECT_EQ(read_triangles, triangles);
  EXPECT_GT(smooth_triangles(scene), 1000u);
  EXPECT_EQ(smooth_triangles(read), smooth_triangles(scene));
  EXPECT_EQ(scene_bounds(read).min, scene_bounds(scene).min);
  EXPECT_EQ(scene_bounds(read).max, scene_bounds(scene).max);
  ASSERT_EQ(read.cameras.size(), 1u);
  EXPECT_EQ(read.cameras[0].name, "demo");
  EXPECT_EQ(read.cameras[0].fov_y, scene.cameras[0].fov_y);
  EXPECT_TRUE(read.cameras[0].to_world.equalWithAbsError(scene.cameras[0].to_world, 1e-6f));
  ASSERT_GE(read.materials.size(), 1u);
  EXPECT_EQ(read.materials[0].name, "leaf");
  EXPECT_EQ(read.materials[0].alpha, 0.85f);
}

TEST(GlbWriter, AFileThatCannotBeWrittenLeavesNothingBehind) {
  const Folder folder;
  Scene scene = small_scene();
  EXPECT_THROW(write_glb(scene, folder.file("no/such/folder.glb")), Error);
  scene.meshes[0].positions[1].x = std::numeric_limits<float>::infinity();
  EXPECT_THROW(write_glb(scene, folder.file("scene.glb")), Error);
  EXPECT_EQ(folder.count(), 0);
}

TEST(GlbWriter, AFolderWithTheNameOfTheOutputIsNotReplaced) {
  const Folder folder;
  fs::create_directory(folder.file("scene.glb"));
  try {
    write_glb(small_scene(), folder.file("scene.glb"));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failed);
    EXPECT_EQ(error.what(), "cannot write " + folder.file("scene.glb") + ": it is a folder");
  }
  EXPECT_EQ(folder.count(), 1);
}

}  // namespace
}  // namespace dapple
