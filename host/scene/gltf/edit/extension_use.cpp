#include "scene/gltf/edit/extension_use.hpp"

#include <algorithm>

namespace dapple::gltf {
namespace {

/// Whether the element, or one in it, has the extension.
bool is_used(const Json& element, const char* name) {
  if (!element.is_structured()) return false;
  return has_extension(element, name) ||
         std::any_of(element.begin(), element.end(),
                     [name](const Json& part) { return is_used(part, name); });
}

}  // namespace

bool has_extension(const Json& element, const char* name) {
  return element.is_object() && element.contains("extensions") &&
         element["extensions"].contains(name);
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
