// Finds the URIs in a glTF document: members `uri`, and of extensions those such as `schemaUri`.
// In: its JSON, of either kind of nlohmann's. Out: calls of a function.
#pragma once

#include <string>

namespace dapple::gltf {

/// Calls visit(uri, whether an extension has it). Extras are left out.
template <class Json, class Visit>
void for_each_uri(const Json& element, const Visit& visit, bool in_extensions = false) {
  for (const auto& [key, value] : element.items()) {
    if (key == "extras") continue;
    if ((key == "uri" || key.ends_with("Uri")) && value.is_string())
      visit(value.template get<std::string>(), in_extensions);
    if (value.is_structured()) for_each_uri(value, visit, in_extensions || key == "extensions");
  }
}

}  // namespace dapple::gltf
