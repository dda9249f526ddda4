// The two questions that validation asks of every element, in 64 bits: does what it names
// exist, and is there room for what it reads?
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scene/gltf/document.hpp"

namespace dapple::gltf {

/// Every function throws Error input, beginning with `who`, when the answer is no.
class ElementCheck {
 public:
  explicit ElementCheck(const std::string& file) : file_(file) {}

  /// `index` is -1 where the property is absent.
  void index(const std::string& who, const char* kind, int index, std::size_t count) const;

  void range(const std::string& who, std::uint64_t needs, std::uint64_t has,
             const std::string& container) const;

  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  const std::string& file_;
};

/// Meshes, their primitives and morph targets, once accessors are known to be sound.
void validate_meshes(const Document& document, const ElementCheck& check);

/// Skins and animations, once accessors and what nodes name are known to be sound.
void validate_motion(const Document& document);

/// What nodes name.
void validate_nodes(const Document& document, const ElementCheck& check);

/// The transforms of a document's nodes, before tinygltf drops one of two. Throws Error input.
void check_transforms(const nlohmann::json& nodes, const std::string& file);

}  // namespace dapple::gltf
