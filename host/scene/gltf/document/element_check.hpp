// The two checks that validation makes for every element, in 64-bit arithmetic: whether the element
// that an index names exists, and whether a byte range lies within its container. In: a document;
// out: an Error when a check fails.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scene/gltf/document/document.hpp"

namespace dapple::gltf {

/// Every function throws Error input, naming `who`, when the check fails.
class ElementCheck {
 public:
  explicit ElementCheck(const std::string& file) : file_(file) {}

  /// Checks that `index` is below `count`; -1 means that the property is absent.
  void index(const std::string& who, const char* kind, int index, std::size_t count) const;

  /// Checks that `needs` is at most `has`, both in bytes.
  void range(const std::string& who, std::uint64_t needs, std::uint64_t has,
             const std::string& container) const;

  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  const std::string& file_;
};

/// Validates meshes, their primitives and morph targets. Accessors must have been validated before.
void validate_meshes(const Document& document, const ElementCheck& check);

/// Validates skins and animations. Accessors, meshes and nodes must have been validated before.
void validate_motion(const Document& document);

/// Validates the indices that nodes have.
void validate_nodes(const Document& document, const ElementCheck& check);

/// Checks the transforms of a document's nodes in the JSON, because tinygltf drops one of a matrix
/// and another transform when a node has both. Throws Error input.
void check_transforms(const nlohmann::json& nodes, const std::string& file);

}  // namespace dapple::gltf
