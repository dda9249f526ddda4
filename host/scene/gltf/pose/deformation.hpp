// Deforms vertices: morph targets are added to their positions and normals, then joints move them
// (skinning). In: the weights and joint matrices of a node's mesh; out: the position and normal of
// each vertex.
#pragma once

#include <Imath/ImathMatrix.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/document.hpp"

namespace dapple::gltf {

struct Deformation {
  std::vector<double> weights;  ///< of morph targets; missing ones are 0
  /// One matrix per joint, from the mesh in its bind pose to the world; null: not skinned.
  const std::vector<Imath::M44d>* joints = nullptr;
};

/// Whether a primitive has joints and weights for its vertices.
bool has_joints(const tinygltf::Primitive& primitive);

/// Returns how many numbers the deformation of `vertices` vertices of a primitive reads. Reads no
/// geometry itself.
std::uint64_t deformation_cost(const Document& document, const tinygltf::Primitive& primitive,
                               const Deformation& deformation, std::uint64_t vertices);

class VertexDeformer {
 public:
  /// Keeps references to `deformation` and `who`. Throws Error input, naming `who`, for accessors
  /// of a type that glTF does not allow there.
  VertexDeformer(const Document& document, const tinygltf::Primitive& primitive,
                 const Deformation& deformation, const std::string& who);

  /// Returns the deformed position of vertex `i`, whose position in the file is `base`. Throws
  /// Error input for a joint that the skin does not have.
  [[nodiscard]] Imath::V3f position(Imath::V3f base, std::uint64_t i) const;

  /// Returns the deformed normal of vertex `i`, whose normal in the file is `base`; of any length.
  /// Throws like position().
  [[nodiscard]] Imath::V3d normal(Imath::V3f base, std::uint64_t i) const;

 private:
  struct Influences {
    AccessorReader joints, weights;  ///< four per vertex
  };

  void read_targets(const Document& document, const tinygltf::Primitive& primitive);
  void read_influences(const Document& document, const tinygltf::Primitive& primitive);
  [[nodiscard]] Imath::V3d carried(const Imath::V3d& position, std::uint64_t i) const;
  [[nodiscard]] Imath::M44d blended(std::uint64_t i) const;
  [[nodiscard]] const Imath::M44d& joint(const Influences& set, std::uint64_t i,
                                         std::uint64_t k) const;

  const Deformation& deformation_;
  const std::string& file_;
  const std::string& who_;
  std::vector<std::pair<double, AccessorReader>> targets_, normal_targets_;
  std::vector<Influences> influences_;
};

/// Returns the matrices of a skin's joints, from the mesh in its bind pose to the world. `world`
/// has the world matrix of each node.
std::vector<Imath::M44d> joint_matrices(const Document& document, int skin,
                                        const std::vector<Imath::M44d>& world);

}  // namespace dapple::gltf
