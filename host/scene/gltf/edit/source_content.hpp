// The private fields of SourceFile: the bytes and JSON of the file, and the document read from
// them. In: a SourceFile. Out: what the writers in this folder read and change.
#pragma once

#include <nlohmann/json.hpp>

#include "scene/gltf/document/container.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/edit/source_file.hpp"

namespace dapple::gltf {

using Json = nlohmann::ordered_json;

struct SourceFile::Content {
  Bytes bytes;
  Container container;
  Document document;
  Json json;
  std::uint32_t meshes_of_file = 0;  ///< later ones are copies

  [[nodiscard]] const tinygltf::Primitive& primitive(std::uint32_t mesh,
                                                     std::uint32_t index) const {
    return document.model.meshes[mesh].primitives[index];
  }
};

}  // namespace dapple::gltf
