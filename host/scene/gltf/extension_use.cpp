#include "scene/gltf/extension_use.hpp"

#include <algorithm>

namespace dapple::gltf {
namespace {

bool is_used(const Json& json, const char* name) {
  const auto has_it = [name](const Json& element) { return has_extension(element, name); };
  const Json none = Json::array();
  const Json& nodes = json.contains("nodes") ? json["nodes"] : none;
  const Json& meshes = json.contains("meshes") ? json["meshes"] : none;
  return std::any_of(nodes.begin(), nodes.end(), has_it) ||
         std::any_of(meshes.begin(), meshes.end(), [&](const Json& mesh) {
           if (!mesh.contains("primitives")) return false;
           const Json& primitives = mesh["primitives"];
           return std::any_of(primitives.begin(), primitives.end(), has_it);
         });
}

}  // namespace

bool has_extension(const Json& element, const char* name) {
  return element.contains("extensions") && element["extensions"].contains(name);
}

bool remove_extension(Json& element, const char* name) {
  if (!has_extension(element, name)) return false;
  element["extensions"].erase(name);
  if (element["extensions"].empty()) element.erase("extensions");
  return true;
}

void unlist_unused_extension(Json& json, const char* name) {
  if (is_used(json, name)) return;
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!json.contains(list)) continue;
    for (std::size_t i = json[list].size(); i-- > 0;)
      if (json[list][i] == name) json[list].erase(i);
    if (json[list].empty()) json.erase(list);
  }
}

}  // namespace dapple::gltf
