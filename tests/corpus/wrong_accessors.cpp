// Accessors that are valid alone but wrong where they are used: indices beyond the vertices, sparse
// indices out of order, attributes of different lengths, instances whose attributes differ in
// number.
#include "corpus/corpus.hpp"

namespace dapple::test {
namespace {

void add(MalformedCases& cases, const char* name, const GltfBuilder& builder, const char* says) {
  cases.push_back({std::string("accessor_") + name, as_glb(builder), says});
}

template <typename Index>
GltfBuilder indexed(const std::vector<Index>& indices, int component, const char* type = "SCALAR") {
  GltfBuilder builder = one_triangle();
  builder.doc["meshes"][0]["primitives"][0]["indices"] =
      builder.add_accessor(indices, component, type);
  return builder;
}

void add_indices(MalformedCases& cases) {
  add(cases, "u8_index_past_the_vertices", indexed<std::uint8_t>({0, 1, 3}, kUint8),
      "index 2 names vertex 3");
  add(cases, "u16_index_past_the_vertices", indexed<std::uint16_t>({0, 1, 3}, kUint16),
      "index 2 names vertex 3");
  add(cases, "u32_index_past_the_vertices", indexed<std::uint32_t>({0, 1, 3}, kUint32),
      "index 2 names vertex 3");
  add(cases, "u8_restart", indexed<std::uint8_t>({0, 1, 255}, kUint8), "names vertex 255");
  add(cases, "u16_restart", indexed<std::uint16_t>({0, 1, 65535}, kUint16), "names vertex 65,535");
  add(cases, "u32_restart", indexed<std::uint32_t>({0, 1, 0xffffffffu}, kUint32),
      "names vertex 4,294,967,295");
  add(cases, "index_of_31_bits", indexed<std::uint32_t>({0x7fffffffu, 1, 2}, kUint32),
      "names vertex 2,147,483,647");
  add(cases, "float_indices", indexed<float>({0, 1, 2}, kFloat), "mesh 0 primitive 0 indices");
  add(cases, "i16_indices", indexed<std::int16_t>({0, 1, 2}, kInt16), "mesh 0 primitive 0 indices");
  add(cases, "vector_indices", indexed<std::uint16_t>({0, 1, 2, 0, 1, 2, 0, 1, 2}, kUint16, "VEC3"),
      "mesh 0 primitive 0 indices");
  add(cases, "four_indices", indexed<std::uint16_t>({0, 1, 2, 0}, kUint16), "whole triangles");
  GltfBuilder unknown = one_triangle();
  unknown.doc["meshes"][0]["primitives"][0]["indices"] = 9;
  add(cases, "unknown_indices", unknown, "mesh 0 primitive 0 names accessor 9");
}

GltfBuilder sparse(const std::vector<std::uint16_t>& at, json edits = json::object()) {
  GltfBuilder builder = one_triangle();
  const int indices = builder.add_view(pack(at));
  const int values = builder.add_view(Bytes(12 * at.size(), 0));
  json value = {{"count", at.size()},
                {"indices", {{"bufferView", indices}, {"componentType", kUint16}}},
                {"values", {{"bufferView", values}}}};
  value.merge_patch(edits);
  builder.doc["accessors"][0]["sparse"] = value;
  return builder;
}

void add_sparse(MalformedCases& cases) {
  add(cases, "sparse_index_past_the_count", sparse({0, 3}), "accessor 0: sparse index 1 is 3");
  add(cases, "sparse_indices_that_fall", sparse({2, 1}), "accessor 0: sparse index 1 is 1");
  add(cases, "sparse_indices_that_repeat", sparse({1, 1}), "accessor 0: sparse index 1 is 1");
  add(cases, "sparse_count_of_zero", sparse({1}, {{"count", 0}}), "accessor 0 replaces 0");
  add(cases, "sparse_count_past_the_accessor", sparse({0, 1, 2, 3}), "accessor 0 replaces 4");
  add(cases, "sparse_count_of_31_bits", sparse({1}, {{"count", 2147483647}}),
      "accessor 0 replaces");
  add(cases, "sparse_indices_of_floats", sparse({1}, {{"indices", {{"componentType", kFloat}}}}),
      "accessor 0 has sparse indices");
  add(cases, "sparse_indices_past_their_view", sparse({1, 2}, {{"indices", {{"byteOffset", 2}}}}),
      "sparse.indices reads past");
  add(cases, "sparse_values_past_their_view", sparse({1, 2}, {{"values", {{"byteOffset", 4}}}}),
      "sparse.values reads past");
  add(cases, "sparse_values_unaligned", sparse({1, 2}, {{"values", {{"byteOffset", 2}}}}),
      "sparse.values begins at byte 2");
  add(cases, "sparse_values_of_an_unknown_view", sparse({1}, {{"values", {{"bufferView", 9}}}}),
      "sparse.values names bufferView 9");
  add(cases, "sparse_without_values", sparse({1}, {{"values", nullptr}}),
      "accessor 0 sparse: values is missing");
}

void add_attributes(MalformedCases& cases) {
  const auto with = [](const char* name, const std::vector<float>& values, const char* type) {
    GltfBuilder builder = one_triangle();
    builder.add("materials", {{"alphaMode", "BLEND"}});
    builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
    builder.doc["meshes"][0]["primitives"][0]["attributes"][name] =
        builder.add_accessor(values, kFloat, type);
    return builder;
  };
  add(cases, "fewer_uvs", with("TEXCOORD_0", {0, 0, 1, 1}, "VEC2"), "but 2 of TEXCOORD_0");
  add(cases, "more_colors", with("COLOR_0", std::vector<float>(16, 1), "VEC4"), "but 4 of COLOR_0");
  add(cases, "fewer_normals", with("NORMAL", {0, 0, 1}, "VEC3"), "but 1 of NORMAL");
  add(cases, "scalar_colors", with("COLOR_0", {1, 1, 1}, "SCALAR"), "primitive 0 COLOR_0");
  add(cases, "fewer_custom_values", with("_AGE", {1}, "SCALAR"), "but 1 of _AGE");
  GltfBuilder target = one_triangle();
  target.doc["meshes"][0]["primitives"][0]["targets"] = {
      {{"POSITION", target.add_positions({0, 0, 1})}}};
  add(cases, "shorter_target", target, "target 0 has 3 vertices, but 1 of POSITION");
}

void add_instances(MalformedCases& cases) {
  const auto instanced = [](const std::vector<float>& values, const char* name, const char* type) {
    GltfBuilder builder = one_triangle();
    auto& attributes =
        builder.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["TRANSLATION"] = builder.add_positions({0, 0, 0, 2, 0, 0});
    attributes[name] = builder.add_accessor(values, kFloat, type);
    return builder;
  };
  add(cases, "instances_that_differ", instanced({1, 1, 1}, "SCALE", "VEC3"),
      "node 0: instance attributes differ");
  add(cases, "instances_turned_by_vec3", instanced({0, 0, 0, 0, 0, 0}, "ROTATION", "VEC3"),
      "node 0 instance ROTATION");
  GltfBuilder unknown = one_triangle();
  unknown.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = 8;
  add(cases, "instances_of_an_unknown_accessor", unknown, "node 0 instance SCALE names accessor 8");
}

}  // namespace

void add_wrong_accessors(MalformedCases& cases) {
  add_indices(cases);
  add_sparse(cases);
  add_attributes(cases);
  add_instances(cases);
}

}  // namespace dapple::test
