// Shared by the tests of the command dapple bake: files in a folder, their JSON, and a small file
// with much that must be kept.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "support/gltf_builder.hpp"
#include "support/program_run.hpp"

namespace dapple::program_test {

using nlohmann::json;
using test::GltfBuilder;

class BakeCommand : public ProgramRun {
 protected:
  void write(const std::string& name, const test::Bytes& bytes) const {
    std::ofstream(path(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  [[nodiscard]] json document(const std::string& name) const {
    const std::string bytes = film_test::bytes_of(path(name));
    if (bytes.substr(0, 4) != "glTF") return json::parse(bytes);
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    return json::parse(bytes.substr(20, length));
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
