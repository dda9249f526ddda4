// A skinned and animated glTF scene: a tube with colours of a texture, whose vertices follow three
// joints each in other parts, shown by two nodes with a skin each, and an animation with the three
// interpolations. Each vertex has numbers of its own, so that a test sees which one was copied.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {

class Reed {
 public:
  Reed() {
    add_material();
    const int mesh = add_tube();
    for (int i = 0; i < 2; ++i) {
      const int root = add_joints(i);
      const json bind = i == 0 ? json(add_bind_matrices()) : json();
      json skin = {{"name", "skin " + std::to_string(i)},
                   {"joints", {root + 2, root + 1, root}},
                   {"skeleton", root + 2}};
      if (!bind.is_null()) skin["inverseBindMatrices"] = bind;
      roots_.push_back(root + 2);
      roots_.push_back(file.add("nodes", {{"name", "reed " + std::to_string(i)},
                                          {"mesh", mesh},
                                          {"skin", file.add("skins", skin)}}));
    }
    add_animation();
    file.add("scenes", {{"nodes", roots_}});
  }

  GltfBuilder file;

 private:
  static constexpr int kSides = 12, kRings = 5;

  void add_material() {
    const int image = file.add(
        "images", {{"bufferView", file.add_view(png::with_alpha(2, 2, {255, 200, 150, 255}))},
                   {"mimeType", "image/png"}});
    const int texture = file.add("textures", {{"source", image}});
    file.add("materials", {{"name", "reed"},
                           {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
  }

  /// 2 m high. The texture goes around it four times, so its coordinates hold no baked values.
  int add_tube() {
    std::vector<float> positions, normals, uvs;
    std::vector<std::uint8_t> joints;
    std::vector<std::uint16_t> weights, indices;
    for (int ring = 0; ring < kRings; ++ring) {
      for (int side = 0; side < kSides; ++side) {
        const float angle = 2 * 3.14159265f * static_cast<float>(side) / kSides;
        const float c = std::cos(angle), s = std::sin(angle), y = 0.5f * static_cast<float>(ring);
        positions.insert(positions.end(), {0.3f * c, y, 0.3f * s});
        normals.insert(normals.end(), {c, 0, s});
        uvs.insert(uvs.end(), {static_cast<float>(side) / 3, y});
        const int vertex = kSides * ring + side, upper = ring < 2 ? 1 : 2;
        joints.insert(joints.end(), {static_cast<std::uint8_t>(upper - 1),
                                     static_cast<std::uint8_t>(upper), 0, 0});
        const auto share = static_cast<std::uint16_t>(1000 * vertex + 7);
        weights.insert(weights.end(), {share, static_cast<std::uint16_t>(65535 - share), 0, 0});
        if (ring + 1 == kRings) continue;
        const int next = kSides * ring + (side + 1) % kSides;
        for (const int corner :
             {vertex, vertex + kSides, next, next, vertex + kSides, next + kSides})
          indices.push_back(static_cast<std::uint16_t>(corner));
      }
    }
    const int position = file.add_positions(positions);
    file.doc["accessors"][position]["min"] = {-0.3f, 0, -0.3f};
    file.doc["accessors"][position]["max"] = {0.3f, 2, 0.3f};
    const json attributes = {{"POSITION", position},
                             {"NORMAL", file.add_accessor(normals, kFloat, "VEC3")},
                             {"TEXCOORD_0", file.add_accessor(uvs, kFloat, "VEC2")},
                             {"JOINTS_0", file.add_accessor(joints, kUint8, "VEC4")},
                             {"WEIGHTS_0", file.add_accessor(weights, kUint16, "VEC4", true)}};
    return file.add("meshes", {{"name", "tube"},
                               {"primitives",
                                {{{"attributes", attributes},
                                  {"indices", file.add_accessor(indices, kUint16, "SCALAR")},
                                  {"material", 0}}}}});
  }

  /// Three nodes, each the child of the next one. Returns the index of the first, the uppermost.
  int add_joints(int reed) {
    const std::string of_reed = " of reed " + std::to_string(reed);
    const int tip = file.add("nodes", {{"name", "tip" + of_reed}, {"translation", {0, 1, 0}}});
    const int middle = file.add("nodes", {{"name", "middle" + of_reed},
                                          {"children", {tip}},
                                          {"translation", {0, 0.75, 0}},
                                          {"rotation", {0, 0, 0.28, 0.96}}});
    file.add("nodes", {{"name", "foot" + of_reed},
                       {"children", {middle}},
                       {"translation", {2 * reed, 0.25 * reed, 0}}});
    return tip;
  }

  /// Of joints at the heights 0, 0.75 and 1.75.
  int add_bind_matrices() {
    std::vector<float> matrices;
    for (const float y : {0.0f, 0.75f, 1.75f})
      matrices.insert(matrices.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -y, 0, 1});
    return file.add("accessors", {{"bufferView", file.add_view(pack(matrices))},
                                  {"componentType", kFloat},
                                  {"count", 3},
                                  {"type", "MAT4"}});
  }

  void add_animation() {
    const auto input = [&](const std::vector<float>& times) {
      const int index = file.add_accessor(times, kFloat, "SCALAR");
      file.doc["accessors"][index]["min"] = {times.front()};
      file.doc["accessors"][index]["max"] = {times.back()};
      return index;
    };
    const auto output = [&](const std::vector<float>& values, const char* type) {
      return file.add_accessor(values, kFloat, type);
    };
    const int turns = output({0, 0, 0, 1, 0, 0, 0.6f, 0.8f, 0, 0.28f, 0, 0.96f}, "VEC4");
    // Of two keyframes the tangent before, the value and the tangent after.
    const int places = output({0, 0, 0, 0, 0, 0, 1, 0, 2, 0, 3, 0, 0.5f, 0, 1, 0, 0, 0}, "VEC3");
    const json samplers = {
        {{"input", input({0, 0.5f, 2})}, {"output", turns}, {"interpolation", "LINEAR"}},
        {{"input", input({0.25f, 1})}, {"output", places}, {"interpolation", "CUBICSPLINE"}},
        {{"input", input({0, 0.25f})},
         {"output", output({1, 1, 1, 2, 1, 2}, "VEC3")},
         {"interpolation", "STEP"}}};
    json channels = json::array();
    for (const auto& [sampler, node, what] :
         {std::tuple{0, 1, "rotation"}, {1, 2, "translation"}, {2, 4, "scale"}, {0, 5, "rotation"}})
      channels.push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", what}}}});
    file.add("animations", {{"name", "sway"}, {"samplers", samplers}, {"channels", channels}});
  }

  std::vector<int> roots_;
};

}  // namespace dapple::test
