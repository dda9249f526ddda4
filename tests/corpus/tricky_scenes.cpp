// The same card with all kinds of node transforms, names and lists, and with elements that are not
// shown.
#include "corpus/stage.hpp"

namespace dapple::test {
namespace {

const json kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

void add_transforms(TrickyCases& cases) {
  cases.push_back(
      twisted("identity_matrix", [](GltfBuilder& b) { b.doc["nodes"][1]["matrix"] = kIdentity; }));
  cases.push_back(twisted("identity_parts", [](GltfBuilder& b) {
    b.doc["nodes"][1].update(
        {{"translation", {0, 0, 0}}, {"rotation", {-0.0, 0.0, -0.0, -1}}, {"scale", {1, 1, 1}}});
  }));
  cases.push_back(twisted("mirrored", [](GltfBuilder& b) {
    b.doc["nodes"][1]["scale"] = {1, 1, -1};
  }));
  cases.push_back(twisted("mirrored_twice", [](GltfBuilder& b) {
    b.doc["nodes"][1]["scale"] = {1, 1, -1};
    b.add("nodes", {{"children", {1}}, {"scale", {1, 1, -1}}});
  }));
  cases.push_back(twisted("rotation_almost_of_length_one", [](GltfBuilder& b) {
    b.doc["nodes"][1]["rotation"] = {0, 0, 0, 0.9995};
  }));
  cases.push_back(twisted("scales_that_cancel", [](GltfBuilder& b) {
    b.doc["nodes"][1]["scale"] = {1e10, 1e10, 1e10};
    b.add("nodes", {{"children", {1}}, {"scale", {1e-10, 1e-10, 1e-10}}});
  }));
  cases.push_back(twisted("translations_that_cancel", [](GltfBuilder& b) {
    b.doc["nodes"][1]["translation"] = {1048576, 0, -4194304};
    b.add("nodes", {{"children", {1}}, {"translation", {-1048576, 0, 4194304}}});
  }));
  cases.push_back(twisted("a_long_chain", [](GltfBuilder& b) {
    int child = 1;
    for (int i = 0; i < 500; ++i) child = b.add("nodes", {{"children", {child}}});
  }));
  cases.push_back(card("mesh_of_1e_minus_20_scaled_up", [](GltfBuilder& b) {
    auto positions = kCardTriangles;
    for (float& value : positions) value *= 0x1p-60f;
    b.add_mesh({{"attributes", {{"POSITION", b.add_positions(positions)}}}});
    b.doc["nodes"][1]["scale"] = {0x1p60, 0x1p60, 0x1p60};
  }));
  cases.push_back(twisted("gpu_instance_of_one", [](GltfBuilder& b) {
    auto& attributes = b.doc["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["TRANSLATION"] = b.add_positions({0, 0, 0});
    attributes["ROTATION"] =
        b.add_accessor(std::vector<std::int8_t>{0, 0, 0, 127}, kInt8, "VEC4", true);
    attributes["SCALE"] = b.add_positions({1, 1, 1});
    b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  }));
}

void add_unshown(TrickyCases& cases) {
  cases.push_back(twisted("a_node_scaled_to_nothing", [](GltfBuilder& b) {
    b.add("nodes", {{"mesh", 1}, {"scale", {0, 0, 0}}, {"translation", {0, 1, 1}}});
  }));
  cases.push_back(twisted("a_node_scaled_flat", [](GltfBuilder& b) {
    b.add("nodes", {{"mesh", 0}, {"scale", {0, 1, 1}}});
  }));
  cases.push_back(twisted("a_node_outside_of_the_scene", [](GltfBuilder& b) {
    b.add("nodes", {{"mesh", 1}, {"translation", {0, 0, 1}}});
    b.doc["scenes"] = {{{"nodes", {0, 1}}}};
    b.doc["scene"] = 0;
  }));
  cases.push_back(twisted("the_second_scene", [](GltfBuilder& b) {
    b.add("nodes", {{"mesh", 1}, {"translation", {0, 0, 1}}});
    b.doc["scenes"] = {{{"nodes", {2}}}, {{"nodes", {0, 1}}}};
    b.doc["scene"] = 1;
  }));
  cases.push_back(twisted("no_default_scene", [](GltfBuilder& b) {
    b.doc["scenes"] = {{{"nodes", {0, 1}}}};
  }));
  cases.push_back(twisted("a_node_in_two_scenes", [](GltfBuilder& b) {
    b.doc["scenes"] = {{{"nodes", {0, 1}}}, {{"nodes", {1}}}};
    b.doc["scene"] = 0;
  }));
  cases.push_back(twisted("an_empty_scene_beside", [](GltfBuilder& b) {
    b.doc["scenes"] = {{{"nodes", {0, 1}}}, json::object()};
    b.doc["scene"] = 0;
  }));
  cases.push_back(
      twisted("a_node_of_nothing", [](GltfBuilder& b) { b.add("nodes", json::object()); }));
  cases.push_back(twisted("a_dark_light", [](GltfBuilder& b) {
    b.doc["extensionsUsed"] = {"KHR_lights_punctual"};
    b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 0}}};
  }));
  cases.push_back(twisted("an_unused_camera", [](GltfBuilder& b) {
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.1}, {"znear", 1}}}});
  }));
}

void add_names(TrickyCases& cases) {
  const auto named = [](const char* name, const std::string& text) {
    return twisted(name, [&](GltfBuilder& b) {
      for (const char* array : {"meshes", "nodes"}) {
        for (json& element : b.doc[array]) element["name"] = text;
      }
      b.doc["materials"] = {{{"name", text}}, {{"name", text}}};
      b.doc["meshes"][1]["primitives"][0]["material"] = 1;
    });
  };
  cases.push_back(named("names_empty", ""));
  cases.push_back(named("names_alike", "leaf"));
  cases.push_back(named("names_of_paths", "../../etc/passwd"));
  cases.push_back(named("names_of_emoji", "\xf0\x9f\x8c\xb3 \xe6\xa8\xb9 \xd8\xb4"));
  cases.push_back(named("names_of_control_characters", std::string("a\n\t\x1b[31m\0b", 11)));
  cases.push_back(named("names_of_formats", "%s%n{}{0}"));
  cases.push_back(named("names_very_long", std::string(100000, 'n')));
}

json deep_extras(int depth) {
  json value = 1;
  for (int i = 0; i < depth; ++i) value = {{"deeper", json::array({value})}};
  return value;
}

void add_lists(TrickyCases& cases) {
  cases.push_back(twisted("extras_everywhere", [](GltfBuilder& b) {
    b.doc["extras"] = deep_extras(20);
    b.doc["asset"]["extras"] = "text";
    for (const char* array : {"accessors", "bufferViews", "meshes", "nodes"}) {
      for (json& element : b.doc[array]) element["extras"] = deep_extras(10);
    }
    b.doc["meshes"][1]["primitives"][0]["extras"] = json::array({1, nullptr, false});
  }));
  cases.push_back(twisted("unknown_properties", [](GltfBuilder& b) {
    b.doc["future"] = {1, 2, 3};
    b.doc["nodes"][1]["visible"] = false;
    b.doc["meshes"][1]["primitives"][0]["lod"] = "none";
  }));
  cases.push_back(twisted("unknown_extensions", [](GltfBuilder& b) {
    b.doc["extensionsUsed"] = {"ACME_wind", "EXT_structural_metadata"};
    b.doc["extensions"]["ACME_wind"] = {{"speed", 3}};
    b.doc["nodes"][1]["extensions"]["ACME_wind"] = {{"mesh", -1}};
    b.doc["meshes"][1]["primitives"][0]["extensions"]["ACME_wind"] = json::object();
  }));
  cases.push_back(twisted("known_extensions_required", [](GltfBuilder& b) {
    b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {
        "KHR_materials_unlit", "KHR_texture_transform", "KHR_lights_punctual"};
  }));
  cases.push_back(twisted("empty_lists", [](GltfBuilder& b) {
    for (const char* array : {"materials", "textures", "images", "samplers", "cameras", "skins",
                              "animations", "extensionsUsed", "extensionsRequired"}) {
      b.doc[array] = json::array();
    }
    b.doc["nodes"][1]["children"] = json::array();
  }));
  cases.push_back(twisted("integers_with_a_point", [](GltfBuilder& b) {
    b.doc["nodes"][1]["mesh"] = 1.0;
    b.doc["accessors"][1]["count"] = 6.0;
    b.doc["meshes"][1]["primitives"][0]["mode"] = 4.0;
  }));
  cases.push_back(
      twisted("version_2_5", [](GltfBuilder& b) { b.doc["asset"]["version"] = "2.5"; }));
}

}  // namespace

void add_tricky_scenes(TrickyCases& cases) {
  add_transforms(cases);
  add_unshown(cases);
  add_names(cases);
  add_lists(cases);
}

}  // namespace dapple::test
