// Validates nodes: the elements that they name exist, and their transforms are valid. In: a
// Document or the JSON of its nodes; out: an error. hierarchy.cpp checks that the nodes form a
// tree.
#include <cmath>
#include <nlohmann/json.hpp>

#include "scene/gltf/document/element_check.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

/// The allowed difference of a rotation's length from 1: exporters round. Viewers disagree about
/// whether a longer or shorter rotation also scales.
constexpr double kRotationTolerance = 0.05;

void check_rotation(const std::string& file, const std::string& who, const Json& rotation) {
  double squares = 0;
  for (const Json& part : rotation) squares += part.get<double>() * part.get<double>();
  const double length = std::sqrt(squares);
  if (length < 1e-6) fail(file, "{} has a rotation of length zero", who);
  if (std::abs(length - 1) <= kRotationTolerance) return;
  fail(file, "{} has a rotation of length {:g}, not 1", who, length);
}

void check_extensions_of(const Document& document, const std::string& who,
                         const tinygltf::Node& node, const ElementCheck& check) {
  const auto light = node.extensions.find(extension::kLights);
  if (light != node.extensions.end()) {
    check.index(who, "light", light->second.Get("light").GetNumberAsInt(),
                document.model.lights.size());
  }
  const auto instancing = node.extensions.find(extension::kInstancing);
  if (instancing == node.extensions.end()) return;
  const auto& attributes = instancing->second.Get("attributes");
  for (const std::string& name : attributes.Keys()) {
    check.index(fmt::format("{} instance {}", who, excerpt(name)), "accessor",
                attributes.Get(name).GetNumberAsInt(), document.model.accessors.size());
  }
}

}  // namespace

void check_transforms(const Json& nodes, const std::string& file) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Json& node = nodes[i];
    const std::string who = fmt::format("node {}", i);
    if (const auto rotation = node.find("rotation"); rotation != node.end())
      check_rotation(file, who, *rotation);
    if (!node.contains("matrix")) continue;
    for (const char* part : {"translation", "rotation", "scale"}) {
      if (node.contains(part)) fail(file, "{} has both a matrix and a {}", who, part);
    }
  }
}

void validate_nodes(const Document& document, const ElementCheck& check) {
  const auto& model = document.model;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const auto& node = model.nodes[i];
    const std::string who = element("node", i, node.name);
    check.index(who, "mesh", node.mesh, model.meshes.size());
    check.index(who, "camera", node.camera, model.cameras.size());
    for (const int child : node.children) check.index(who, "node", child, model.nodes.size());
    check_extensions_of(document, who, node, check);
  }
}

}  // namespace dapple::gltf
