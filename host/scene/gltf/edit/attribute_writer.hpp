// Adds vertex attributes and values of instances to a glTF file. In: the values. Out: changes of an
// Editor.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/edit/editor.hpp"

namespace dapple::gltf {

/// How the components of an attribute are stored.
enum class Storage : std::uint8_t {
  float32,
  normalized16,  ///< [0,1] as unsigned 16-bit integers
};

/// Values of all vertices of a primitive, `components` numbers each.
struct NewAttribute {
  std::uint32_t mesh = 0, primitive = 0;  ///< indices in the file
  /// Primitives that share values have the same number here; of attributes of one name and number
  /// only the first one's values count.
  std::size_t shared = 0;
  std::string name;              ///< such as "COLOR_0"; replaced if there is one
  std::uint32_t components = 1;  ///< 1 to 4
  Storage storage = Storage::float32;
  std::vector<float> values;
};

/// Values of the instances of a node: of one as `extras`, of those of EXT_mesh_gpu_instancing as an
/// instance attribute.
struct NodeValues {
  std::uint32_t node = 0;
  std::string extra, attribute;  ///< names, such as "ao" and "_AO"
  std::uint32_t components = 1;  ///< 1 to 4
  std::vector<float> values;
};

void add_attributes(Editor& editor, const std::vector<NewAttribute>& attributes);

/// Returns notes of extras that were not objects, and of values that were replaced.
std::vector<std::string> add_node_values(Editor& editor, const std::vector<NodeValues>& nodes);

}  // namespace dapple::gltf
