// The same card in all the ways in which glTF can store triangles.
#include <algorithm>
#include <limits>

#include "corpus/stage.hpp"

namespace dapple::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

json primitive(int position) { return {{"attributes", {{"POSITION", position}}}}; }

template <typename Index>
Tricky indexed(const char* name, int component, const std::vector<Index>& indices, int mode = 4) {
  return card(name, [&](GltfBuilder& b) {
    json p = primitive(b.add_positions(kCorners));
    p["indices"] = b.add_accessor(indices, component, "SCALAR");
    p["mode"] = mode;
    b.add_mesh(p);
  });
}

void add_topologies(TrickyCases& cases) {
  cases.push_back(indexed<std::uint8_t>("u8_indices", kUint8, {0, 1, 2, 0, 2, 3}));
  cases.push_back(indexed<std::uint16_t>("u16_indices", kUint16, {0, 1, 2, 0, 2, 3}));
  cases.push_back(indexed<std::uint32_t>("u32_indices", kUint32, {0, 1, 2, 0, 2, 3}));
  cases.push_back(indexed<std::uint16_t>("turned_corners", kUint16, {1, 2, 0, 2, 3, 0}));
  cases.push_back(indexed<std::uint16_t>("other_winding", kUint16, {0, 2, 1, 0, 3, 2}));
  cases.push_back(indexed<std::uint8_t>("strip", kUint8, {1, 2, 0, 3}, 5));
  cases.push_back(
      indexed<std::uint16_t>("strip_with_stitches", kUint16, {0, 1, 2, 2, 0, 0, 2, 3}, 5));
  cases.push_back(indexed<std::uint16_t>("fan", kUint16, {0, 1, 2, 3}, 6));
  cases.push_back(indexed<std::uint32_t>("degenerate_indices_among_others", kUint32,
                                         {0, 1, 2, 1, 1, 1, 0, 2, 3, 2, 2, 3}));
  cases.push_back(card("fan_without_indices", [](GltfBuilder& b) {
    json p = primitive(b.add_positions(kCorners));
    p["mode"] = 6;
    b.add_mesh(p);
  }));
  cases.push_back(card("strip_without_indices", [](GltfBuilder& b) {
    json p = primitive(b.add_positions({1, 0, 0, 1, 2, 0, -1, 0, 0, -1, 2, 0}));
    p["mode"] = 5;
    b.add_mesh(p);
  }));
  cases.push_back(card("points_and_lines_beside", [](GltfBuilder& b) {
    json p = primitive(b.add_positions(kCardTriangles));
    b.add_mesh(p);
    for (const int mode : {0, 1, 2, 3}) {
      p["mode"] = mode;
      b.doc["meshes"][1]["primitives"].push_back(p);
    }
  }));
  cases.push_back(card("two_primitives", [](GltfBuilder& b) {
    const int position = b.add_positions(kCorners);
    json first = primitive(position), second = first;
    first["indices"] = b.add_accessor(std::vector<std::uint8_t>{0, 1, 2}, kUint8, "SCALAR");
    second["indices"] = b.add_accessor(std::vector<std::uint8_t>{0, 2, 3}, kUint8, "SCALAR");
    b.add_mesh(first);
    b.doc["meshes"][1]["primitives"].push_back(second);
  }));
}

/// The card's six vertices in a buffer view of this stride. They begin at byte `offset` of each
/// element.
Tricky strided(const char* name, std::size_t stride, std::size_t offset) {
  return card(name, [&](GltfBuilder& b) {
    Bytes bytes;
    for (std::size_t v = 0; v < 6; ++v) {
      Bytes element(stride, 0x7f);
      for (std::size_t c = 0; c < 3; ++c) {
        const Bytes number = pack<float>({kCardTriangles[3 * v + c]});
        std::copy(number.begin(), number.end(),
                  element.begin() + static_cast<std::ptrdiff_t>(offset + 4 * c));
      }
      bytes.insert(bytes.end(), element.begin(), element.end());
    }
    const int view = b.add_view(bytes, static_cast<int>(stride));
    b.add_mesh(primitive(b.add("accessors", {{"bufferView", view},
                                             {"byteOffset", offset},
                                             {"componentType", kFloat},
                                             {"count", 6},
                                             {"type", "VEC3"}})));
  });
}

void add_layouts(TrickyCases& cases) {
  cases.push_back(strided("stride_12", 12, 0));
  cases.push_back(strided("stride_16", 16, 4));
  cases.push_back(strided("stride_32", 32, 8));
  cases.push_back(strided("stride_252", 252, 240));
  cases.push_back(card("offset_into_the_view", [](GltfBuilder& b) {
    std::vector<float> values = {9, 9, 9, 9};
    values.insert(values.end(), kCardTriangles.begin(), kCardTriangles.end());
    const int position = b.add_positions(kCardTriangles);
    b.doc["accessors"][position]["bufferView"] = b.add_view(pack(values));
    b.doc["accessors"][position]["byteOffset"] = 16;
    b.add_mesh(primitive(position));
  }));
  cases.push_back(twisted("limits_that_lie", [](GltfBuilder& b) {
    b.doc["accessors"][1]["min"] = {-9, -9, -9};
    b.doc["accessors"][1]["max"] = {9, 9, 9};
  }));
  cases.push_back(twisted("view_longer_than_its_accessor", [](GltfBuilder& b) {
    b.bin.resize(b.bin.size() + 64, 0x55);
    b.doc["bufferViews"][1]["byteLength"] = 72 + 60;
  }));
  cases.push_back(twisted("more_attributes", [](GltfBuilder& b) {
    json& attributes = b.doc["meshes"][1]["primitives"][0]["attributes"];
    attributes["NORMAL"] = b.add_positions(std::vector<float>(18, 0));
    attributes["_AGE"] = b.add_accessor(std::vector<float>(6, 1), kFloat, "SCALAR");
    attributes["TEXCOORD_7"] = b.add_accessor(std::vector<float>(12, 1), kFloat, "VEC2");
  }));
  cases.push_back(twisted("unused_mesh_of_nan", [](GltfBuilder& b) {
    b.add("meshes",
          {{"primitives", json::array({primitive(b.add_positions(std::vector<float>(9, kNan)))})}});
  }));
}

/// Makes `accessor` sparse: triple i of `values` replaces the element `at[i]`.
template <typename Index>
void make_sparse(GltfBuilder& b, int accessor, int component, const std::vector<Index>& at,
                 const std::vector<float>& values) {
  b.doc["accessors"][accessor]["sparse"] = {
      {"count", at.size()},
      {"indices", {{"bufferView", b.add_view(pack(at))}, {"componentType", component}}},
      {"values", {{"bufferView", b.add_view(pack(values))}}}};
}

template <typename Index>
Tricky sparse(const char* name, int component) {
  return card(name, [&](GltfBuilder& b) {
    auto wrong = kCardTriangles;
    wrong[3] = wrong[17] = 77;
    const int position = b.add_positions(wrong);
    make_sparse<Index>(b, position, component, {1, 5}, {1, 0, 0, -1, 2, 0});
    b.add_mesh(primitive(position));
  });
}

void add_sparse(TrickyCases& cases) {
  cases.push_back(sparse<std::uint8_t>("sparse_u8", kUint8));
  cases.push_back(sparse<std::uint16_t>("sparse_u16", kUint16));
  cases.push_back(sparse<std::uint32_t>("sparse_u32", kUint32));
  cases.push_back(card("sparse_from_zeros", [](GltfBuilder& b) {
    const int position =
        b.add("accessors", {{"componentType", kFloat}, {"count", 6}, {"type", "VEC3"}});
    make_sparse<std::uint8_t>(b, position, kUint8, {0, 1, 2, 3, 4, 5}, kCardTriangles);
    b.add_mesh(primitive(position));
  }));
  cases.push_back(card("sparse_nan_replaced", [](GltfBuilder& b) {
    auto wrong = kCardTriangles;
    wrong[0] = kNan;
    const int position = b.add_positions(wrong);
    make_sparse<std::uint8_t>(b, position, kUint8, {0}, {-1, 0, 0});
    b.add_mesh(primitive(position));
  }));
}

/// The card with integer positions, `scale` integers for two metres (ignored if `normalized`). Each
/// vertex has four integers, for alignment.
template <typename Number>
Tricky quantized(const char* name, int component, double scale, bool normalized) {
  return card(name, [&](GltfBuilder& b) {
    b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
    // The positions are moved by 1, so that none is negative; the node moves them back.
    const double largest = normalized ? std::numeric_limits<Number>::max() : scale;
    Bytes bytes;
    for (std::size_t v = 0; v < kCardTriangles.size(); v += 3) {
      append(bytes, static_cast<Number>((double{kCardTriangles[v]} + 1) / 2 * largest));
      append(bytes, static_cast<Number>(double{kCardTriangles[v + 1]} / 2 * largest));
      append(bytes, Number{0});
      append(bytes, Number{0});
    }
    const int view = b.add_view(bytes, 4 * sizeof(Number));
    b.add_mesh(primitive(b.add("accessors", {{"bufferView", view},
                                             {"componentType", component},
                                             {"count", 6},
                                             {"normalized", normalized},
                                             {"type", "VEC3"}})));
    const double size = normalized ? 2 : 2 / scale;
    b.doc["nodes"][1]["translation"] = {-1, 0, 0};
    b.doc["nodes"][1]["scale"] = {size, size, size};
  });
}

void add_quantized(TrickyCases& cases) {
  cases.push_back(quantized<std::int8_t>("quantized_i8", kInt8, 100, false));
  cases.push_back(quantized<std::uint8_t>("quantized_u8", kUint8, 200, false));
  cases.push_back(quantized<std::int16_t>("quantized_i16", kInt16, 30000, false));
  cases.push_back(quantized<std::uint16_t>("quantized_u16", kUint16, 60000, false));
  cases.push_back(quantized<std::int8_t>("normalized_i8", kInt8, 1, true));
  cases.push_back(quantized<std::uint8_t>("normalized_u8", kUint8, 1, true));
  cases.push_back(quantized<std::int16_t>("normalized_i16", kInt16, 1, true));
  cases.push_back(quantized<std::uint16_t>("normalized_u16", kUint16, 1, true));
}

void add_faulty_triangles(TrickyCases& cases) {
  const auto followed_by = [](const char* name, const std::vector<float>& more) {
    return card(name, [&](GltfBuilder& b) {
      auto positions = kCardTriangles;
      positions.insert(positions.end(), more.begin(), more.end());
      b.add_mesh(primitive(b.add_positions(positions)));
    });
  };
  cases.push_back(followed_by("a_triangle_of_nan", {0, 0, 0, kNan, 1, 0, 0, 1, 1}));
  cases.push_back(followed_by("a_triangle_of_infinity",
                              {0, 0, 0, std::numeric_limits<float>::infinity(), 1, 0, 0, 1, 1}));
  cases.push_back(followed_by("a_triangle_without_area", {0, 0, 0, 1, 1, 1, 2, 2, 2}));
  cases.push_back(followed_by("a_triangle_of_denormals", {0, 0, 0, 1e-42f, 0, 0, 0, 1e-42f, 0}));
  cases.push_back(card("unused_vertices_of_nan", [](GltfBuilder& b) {
    auto positions = kCorners;
    positions.insert(positions.end(), {kNan, kNan, kNan, 1e38f, -1e38f, 1e38f});
    json p = primitive(b.add_positions(positions));
    p["indices"] = b.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, kUint16, "SCALAR");
    b.add_mesh(p);
  }));
}

/// Adds a card whose vertices follow joint 0 of skin 0. Returns its node.
int add_skinned_card(GltfBuilder& b, const std::vector<float>& positions) {
  const std::size_t vertices = positions.size() / 3;
  std::vector<float> weights;
  for (std::size_t i = 0; i < vertices; ++i) weights.insert(weights.end(), {0.75f, 0.25f, 0, 0});
  const int joints = b.add_accessor(std::vector<std::uint16_t>(4 * vertices, 0), kUint16, "VEC4");
  const int node = b.add_mesh({{"attributes",
                                {{"POSITION", b.add_positions(positions)},
                                 {"JOINTS_0", joints},
                                 {"WEIGHTS_0", b.add_accessor(weights, kFloat, "VEC4")}}}});
  b.doc["nodes"][node]["skin"] = 0;
  return node;
}

std::vector<float> raised(std::vector<float> positions, float height) {
  for (std::size_t i = 1; i < positions.size(); i += 3) positions[i] += height;
  return positions;
}

void add_morphs(TrickyCases& cases) {
  cases.push_back(twisted("morph_target_of_weight_zero", [](GltfBuilder& b) {
    b.doc["meshes"][1]["primitives"][0]["targets"] = {
        {{"POSITION", b.add_positions(std::vector<float>(18, 5))}}};
    b.doc["meshes"][1]["weights"] = {0};
  }));
  cases.push_back(twisted("morph_target_without_weights", [](GltfBuilder& b) {
    b.doc["meshes"][1]["primitives"][0]["targets"] = {
        {{"POSITION", b.add_positions(std::vector<float>(18, 5))}}};
  }));
  cases.push_back(card("morph_targets_that_make_the_card", [](GltfBuilder& b) {
    b.add_mesh({{"attributes", {{"POSITION", b.add_positions(std::vector<float>(18, 0))}}},
                {"targets", json::array({{{"POSITION", b.add_positions(kCardTriangles)}},
                                         {{"NORMAL", b.add_positions(kCardTriangles)}}})}});
    b.doc["meshes"][1]["weights"] = {0.5, 3};
    b.doc["nodes"][1]["weights"] = {1, 0};
  }));
}

void add_skins(TrickyCases& cases) {
  cases.push_back(card("skin_in_its_bind_pose", [](GltfBuilder& b) {
    const int node = add_skinned_card(b, raised(kCardTriangles, -3));
    b.doc["nodes"][node]["translation"] = {50, 60, 70};  // has no effect
    b.add("nodes", {{"translation", {0, 3, 0}}});
    b.add("skins", {{"joints", {node + 1}}});
  }));
  cases.push_back(card("skin_with_inverse_matrices", [](GltfBuilder& b) {
    const int node = add_skinned_card(b, kCardTriangles);
    b.add("nodes", {{"translation", {0, 3, 0}}});
    const int view = b.add_view(pack<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -3, 0, 1}));
    const int inverse =
        b.add("accessors",
              {{"bufferView", view}, {"componentType", kFloat}, {"count", 1}, {"type", "MAT4"}});
    b.add("skins", {{"joints", {node + 1}}, {"inverseBindMatrices", inverse}});
  }));
  cases.push_back(twisted("skin_of_a_mesh_without_joints", [](GltfBuilder& b) {
    b.add("skins", {{"joints", {0}}});
    b.doc["nodes"][1]["skin"] = 0;
  }));
  cases.push_back(card("skin_whose_joint_is_in_no_scene", [](GltfBuilder& b) {
    const int node = add_skinned_card(b, kCardTriangles);
    b.add("nodes", json::object());
    b.add("skins", {{"joints", {node + 1}}});
    b.add("scenes", {{"nodes", {0, node}}});
  }));
}

void add_animations(TrickyCases& cases) {
  cases.push_back(twisted("animation_at_rest", [](GltfBuilder& b) {
    const int times = b.add_accessor(std::vector<float>{3, 1}, kFloat, "SCALAR");  // unused at rest
    const int places = b.add_positions({9, 9, 9, 9, 9, 9});
    b.add("animations", {{"samplers", {{{"input", times}, {"output", places}}}},
                         {"channels",
                          {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}},
                           {{"sampler", 0}, {"target", {{"path", "pointer"}}}}}}});
  }));
}

}  // namespace

void add_tricky_geometry(TrickyCases& cases) {
  add_topologies(cases);
  add_layouts(cases);
  add_sparse(cases);
  add_quantized(cases);
  add_faulty_triangles(cases);
  add_morphs(cases);
  add_skins(cases);
  add_animations(cases);
}

}  // namespace dapple::test
