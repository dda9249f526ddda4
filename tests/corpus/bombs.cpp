// Small files that would need much memory or time, and positions and scales that no picture can be
// rendered with.
#include <limits>

#include "corpus/corpus.hpp"

namespace dapple::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kDenormal = std::numeric_limits<float>::denorm_min();

void add(MalformedCases& cases, const std::string& name, const GltfBuilder& builder,
         const char* says) {
  cases.push_back({name, as_glb(builder), says});
}

/// Adds an accessor of `count` zero elements, which needs no bytes. Returns its index.
int zeros(GltfBuilder& builder, std::uint64_t count, const char* type = "VEC3") {
  return builder.add("accessors", {{"componentType", kFloat}, {"count", count}, {"type", type}});
}

GltfBuilder instanced_zeros(std::uint64_t count, int nodes) {
  GltfBuilder builder = one_triangle();
  builder.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      zeros(builder, count);
  while (static_cast<int>(builder.doc["nodes"].size()) < nodes) {
    builder.doc["nodes"].push_back(builder.doc["nodes"][0]);
  }
  return builder;
}

/// Each node has the previous one as a child twice: 2^levels instances in all.
GltfBuilder doubling(int levels) {
  GltfBuilder builder = one_triangle();
  for (int i = 0; i < levels; ++i) builder.add("nodes", {{"children", {i, i}}});
  return builder;
}

GltfBuilder coincident_nodes(int count) {
  GltfBuilder builder = one_triangle();
  for (int i = 1; i < count; ++i) builder.add("nodes", {{"mesh", 0}});
  return builder;
}

/// A mesh with the same strip of `vertices` vertices `primitives` times, from one accessor.
GltfBuilder repeated_strip(int primitives, int vertices) {
  GltfBuilder builder;
  std::vector<float> positions;
  for (int i = 0; i < vertices; ++i) {
    positions.insert(positions.end(), {float(i % 2), float(i / 2), 0});
  }
  const int position = builder.add_positions(positions);
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"mode", 5}});
  json& list = builder.doc["meshes"][0]["primitives"];
  while (static_cast<int>(list.size()) < primitives) list.push_back(list[0]);
  return builder;
}

GltfBuilder chain(int length) {
  GltfBuilder builder = one_triangle();
  for (int i = 1; i < length; ++i) builder.add("nodes", {{"children", {i - 1}}});
  return builder;
}

void add_amplifiers(MalformedCases& cases) {
  add(cases, "bomb_doubling_nodes", doubling(40), "is a child of both");
  add(cases, "bomb_long_chain", chain(100000), "is nested deeper than 65,536");
  add(cases, "bomb_a_billion_instances", instanced_zeros(1000000000, 1), "accessor 1");
  add(cases, "bomb_of_zero_instances", instanced_zeros(4000000, 1), "at one position");
  add(cases, "bomb_of_shared_instances", instanced_zeros(4000000, 20), "brings the instances");
  add(cases, "bomb_coincident_nodes", coincident_nodes(20000), "at one position");
  add(cases, "bomb_of_shared_strips", repeated_strip(4000, 4000), "brings the triangles");
  GltfBuilder many = one_triangle();
  many.doc["accessors"][0].erase("bufferView");
  many.doc["accessors"][0]["count"] = 4294967295u;
  add(cases, "bomb_of_zero_positions", many, "accessor 0 has 4,294,967,295 elements");
  GltfBuilder materials = one_triangle();
  materials.doc["materials"] = json(std::vector<json>(140000, json::object()));
  add(cases, "bomb_of_materials", materials, "materials has 140,000 elements");
}

GltfBuilder triangle_of(const std::vector<float>& positions) {
  GltfBuilder builder;
  builder.add_mesh({{"attributes", {{"POSITION", builder.add_positions(positions)}}}});
  return builder;
}

GltfBuilder scaled(double scale) {
  GltfBuilder builder = one_triangle();
  builder.doc["nodes"][0]["scale"] = {scale, scale, scale};
  return builder;
}

/// Scenes from which all triangles are dropped, or whose numbers float arithmetic cannot render.
void add_numbers(MalformedCases& cases) {
  const char* const says = "scene.glb: ";
  add(cases, "number_nan", triangle_of({0, 0, 0, kNan, 0, 0, 0, 1, 0}), says);
  add(cases, "number_all_nan", triangle_of(std::vector<float>(9, kNan)), says);
  add(cases, "number_infinity", triangle_of({0, 0, 0, kInfinity, 0, 0, 0, 1, 0}), says);
  add(cases, "number_minus_infinity", triangle_of({0, 0, 0, 1, 0, 0, 0, -kInfinity, 0}), says);
  add(cases, "number_point", triangle_of(std::vector<float>(9, 1)), says);
  add(cases, "number_line", triangle_of({0, 0, 0, 1, 0, 0, 2, 0, 0}), says);
  add(cases, "number_denormal", triangle_of({0, 0, 0, kDenormal, 0, 0, 0, kDenormal, 0}), says);
  add(cases, "number_1e_minus_30", triangle_of({0, 0, 0, 1e-30f, 0, 0, 0, 1e-30f, 0}), says);
  add(cases, "number_1e30", triangle_of({0, 0, 0, 1e30f, 0, 0, 0, 1e30f, 0}), says);
  add(cases, "number_largest", triangle_of({-3.4e38f, 0, 0, 3.4e38f, 0, 0, 0, 3.4e38f, 0}), says);
  add(cases, "number_scale_0", scaled(0), says);
  add(cases, "number_scale_1e_minus_40", scaled(1e-40), says);
  add(cases, "number_scale_1e38", scaled(1e38), says);
  GltfBuilder flat = one_triangle();
  flat.doc["nodes"][0]["scale"] = {0, 1, 1};
  add(cases, "number_scale_0_of_one_axis", flat, says);
  GltfBuilder degenerate = one_triangle();
  degenerate.doc["meshes"][0]["primitives"][0]["indices"] =
      degenerate.add_accessor(std::vector<std::uint8_t>{0, 0, 0, 1, 1, 2}, kUint8, "SCALAR");
  add(cases, "number_degenerate_indices", degenerate, says);
}

}  // namespace

void add_bombs(MalformedCases& cases) {
  add_amplifiers(cases);
  add_numbers(cases);
}

}  // namespace dapple::test
