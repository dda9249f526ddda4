// Shared by the tests of the command dapple bake: files in a folder, their JSON, and a small file
// with much that must be kept. Every glTF file that a test leaves behind is checked.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "support/files/gltf_builder.hpp"
#include "support/files/gltf_rules.hpp"
#include "support/programs/program_run.hpp"

namespace dapple::program_test {

using nlohmann::json;
using test::GltfBuilder;

class BakeCommand : public ProgramRun {
 protected:
  void TearDown() override {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".glb" || extension == ".gltf")
        test::expect_valid_gltf(entry.path().string());
    }
  }

  [[nodiscard]] json document(const std::string& name) const {
    return test::GltfData(path(name)).doc;
  }
};

// A triangle in a file with attributes, extras and extensions that dapple does not know.
inline GltfBuilder rich_triangle() {
  GltfBuilder builder;
  builder.add_triangle();
  builder.doc["meshes"][0]["primitives"][0]["attributes"]["_TEMPERATURE"] =
      builder.add_accessor(std::vector<float>{1, 2, 3}, test::kFloat, "SCALAR");
  builder.doc["meshes"][0]["extras"] = {{"season", "autumn"}, {"leaves", {1, 2.5, nullptr}}};
  builder.doc["nodes"][0]["name"] = "twig";
  builder.doc["extensionsUsed"] = {"ACME_wind"};
  builder.doc["extensions"]["ACME_wind"] = {{"speed", 3.25}};
  builder.doc["asset"]["copyright"] = "nobody";
  return builder;
}

}  // namespace dapple::program_test
