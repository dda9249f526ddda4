// A small glTF scene with most of what a file can have that a bake must carry over: leaves with a
// cut-out texture, colours, a morph target and an index buffer that two primitives share, a strip
// without indices, quantized and sparse positions, vertices that nothing uses, instances of the
// extension below a turned node, and a camera that looks at it all.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {

class Garden {
 public:
  Garden() {
    add_materials();
    add_leaves();
    add_trunk();
    add_ground();
    add_tufts();
    const int camera = file.add(
        "cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.01}}}});
    file.add("nodes", {{"camera", camera}, {"translation", {0.2, 1.2, 5}}});
    for (std::size_t i = 0; i < file.doc["nodes"].size(); ++i)
      if (i != static_cast<std::size_t>(tuft_)) scene_nodes_.push_back(i);
    file.add("scenes", {{"nodes", scene_nodes_}});
  }

  GltfBuilder file;

 private:
  static constexpr int kLeaves = 24;

  /// With min and max, which the specification demands of positions and allows elsewhere: a bake
  /// that copies vertices has to find them again.
  template <class T>
  int add_bounded(const std::vector<T>& values, int component, const char* type,
                  bool normalized = false) {
    const int index = file.add_accessor(values, component, type, normalized);
    json& accessor = file.doc["accessors"][index];
    const std::size_t n = values.size() / accessor["count"].get<std::size_t>();
    for (std::size_t c = 0; c < n; ++c) {
      T least = values[c], most = values[c];
      for (std::size_t i = c; i < values.size(); i += n) {
        least = std::min(least, values[i]);
        most = std::max(most, values[i]);
      }
      accessor["min"].push_back(least);
      accessor["max"].push_back(most);
    }
    return index;
  }

  int add_mesh(const json& primitives, const std::string& name) {
    const int mesh = file.add("meshes", {{"primitives", primitives}, {"name", name}});
    return file.add("nodes", {{"mesh", mesh}, {"name", name + " node"}});
  }

  void add_materials() {
    const Bytes alphas = {255, 255, 255, 0,   255, 255, 200, 255,
                          255, 30,  255, 255, 0,   255, 255, 255};
    const int image = file.add(
        "images",
        {{"bufferView", file.add_view(png::with_alpha(4, 4, alphas))}, {"mimeType", "image/png"}});
    const int texture = file.add("textures", {{"source", image}});
    file.add("materials", {{"name", "leaf"},
                           {"doubleSided", true},
                           {"alphaMode", "BLEND"},
                           {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
    file.add("materials", {{"name", "bark"}});
  }

  /// Leaves in a crown, each turned about the vertical; the last vertex belongs to no triangle.
  void add_leaves() {
    std::vector<float> positions, normals, uvs, offsets;
    std::vector<std::uint8_t> colors, front, rear;
    for (int i = 0; i < kLeaves; ++i) {
      const float angle = 2.4f * static_cast<float>(i), radius = 0.15f * std::sqrt(1.0f + angle);
      const float c = std::cos(angle), s = std::sin(angle), y = 1 + 0.04f * static_cast<float>(i);
      for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        const float x = radius + 0.5f * static_cast<float>(u), z = 0.4f * static_cast<float>(v);
        positions.insert(positions.end(), {c * x - s * z, y + 0.1f * z, s * x + c * z});
        normals.insert(normals.end(), {0, 1, 0});
        uvs.insert(uvs.end(), {static_cast<float>(u), static_cast<float>(v)});
        offsets.insert(offsets.end(), {0, 0.1f * static_cast<float>(u), 0});
        colors.insert(colors.end(), {200, 255, static_cast<std::uint8_t>(9 * i), 230});
      }
      std::vector<std::uint8_t>& indices = i % 3 == 0 ? rear : front;
      for (const int corner : {0, 1, 2, 0, 2, 3})
        indices.push_back(static_cast<std::uint8_t>(4 * i + corner));
    }
    positions.insert(positions.end(), {9, 9, 9});
    normals.insert(normals.end(), {0, 0, 1});
    uvs.insert(uvs.end(), {5, 5});
    offsets.insert(offsets.end(), {0, 3, 0});
    colors.insert(colors.end(), {0, 0, 0, 0});
    json primitive = {{"attributes",
                       {{"POSITION", add_bounded(positions, kFloat, "VEC3")},
                        {"NORMAL", add_bounded(normals, kFloat, "VEC3")},
                        {"TEXCOORD_0", add_bounded(uvs, kFloat, "VEC2")},
                        {"COLOR_0", add_bounded(colors, kUint8, "VEC4", true)}}},
                      {"targets", {{{"POSITION", add_bounded(offsets, kFloat, "VEC3")}}}},
                      {"material", 0}};
    json second = primitive;
    primitive["indices"] = add_bounded(front, kUint8, "SCALAR");
    second["indices"] = add_bounded(rear, kUint8, "SCALAR");
    const int node = add_mesh({primitive, second}, "leaves");
    file.doc["nodes"][node]["weights"] = {0.5};
    file.doc["nodes"][node]["extras"] = {{"species", "beech"}};
  }

  /// A bent sheet, as a strip of quantized positions.
  void add_trunk() {
    std::vector<std::int16_t> positions;
    std::vector<float> uvs;
    for (int i = 0; i < 6; ++i) {
      const float angle = 1.0f * static_cast<float>(i);
      for (const int y : {-1, 99}) {
        positions.insert(positions.end(), {static_cast<std::int16_t>(15 * std::cos(angle)),
                                           static_cast<std::int16_t>(y),
                                           static_cast<std::int16_t>(-15 * std::sin(angle)), 0});
        uvs.insert(uvs.end(), {0.2f * static_cast<float>(i), 0.01f * static_cast<float>(y + 1)});
      }
    }
    // Elements begin at multiples of four bytes: three numbers and two bytes of padding.
    std::vector<std::int16_t> tight;
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (i % 4 != 3) tight.push_back(positions[i]);
    const int accessor = add_bounded(tight, kInt16, "VEC3");
    file.doc["accessors"][accessor]["bufferView"] = file.add_view(pack(positions), 8);
    file.doc["extensionsUsed"] = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing"};
    file.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
    const int node =
        add_mesh({{{"attributes",
                    {{"POSITION", accessor}, {"TEXCOORD_0", add_bounded(uvs, kFloat, "VEC2")}}},
                   {"mode", 5},
                   {"material", 1}}},
                 "trunk");
    file.doc["nodes"][node]["scale"] = {0.01, 0.01, 0.01};
  }

  /// A square whose corners are the sparse values of an accessor that has no others.
  void add_ground() {
    const std::vector<float> corners = {-2, 0, -2, -2, 0, 2, 2, 0, 2, 2, 0, -2};
    const int where = file.add_view(pack(std::vector<std::uint16_t>{0, 1, 2, 3}));
    const int accessor =
        file.add("accessors", {{"componentType", kFloat},
                               {"count", 4},
                               {"type", "VEC3"},
                               {"min", {-2, 0, -2}},
                               {"max", {2, 0, 2}},
                               {"sparse",
                                {{"count", 4},
                                 {"indices", {{"bufferView", where}, {"componentType", kUint16}}},
                                 {"values", {{"bufferView", file.add_view(pack(corners))}}}}}});
    const std::vector<float> uvs = {0, 0, 0, 1, 1, 1, 1, 0};
    add_mesh({{{"attributes",
                {{"POSITION", accessor}, {"TEXCOORD_0", add_bounded(uvs, kFloat, "VEC2")}}},
               {"indices",
                add_bounded(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}, kUint32, "SCALAR")}}},
             "ground");
  }

  /// Three blades of grass, by the extension, below a node that turns and moves them.
  void add_tufts() {
    const std::vector<float> blade = {0, 0, 0, 0.2f, 0, 0, 0.3f, 0.6f, 0};
    tuft_ = add_mesh(
        {{{"attributes",
           {{"POSITION", add_bounded(blade, kFloat, "VEC3")},
            {"TEXCOORD_0", add_bounded(std::vector<float>{0, 0, 1, 0, 1, 1}, kFloat, "VEC2")}}},
          {"material", 0}}},
        "blade");
    const std::vector<float> places = {-1, 0, 1, -0.7f, 0, 1.2f, 0.8f, 0, 0.9f};
    const std::vector<float> turns = {0, 0, 0, 1, 0, 0.6f, 0, 0.8f, 0.1f, 0.7f, 0.1f, 0.7f};
    file.doc["nodes"][tuft_]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", add_bounded(places, kFloat, "VEC3")},
        {"ROTATION", add_bounded(turns, kFloat, "VEC4")}};
    file.add("nodes",
             {{"children", {tuft_}}, {"rotation", {0, 0.28, 0, 0.96}}, {"scale", {1.2, 1.3, 1}}});
  }

  int tuft_ = -1;
  std::vector<std::size_t> scene_nodes_;
};

}  // namespace dapple::test
