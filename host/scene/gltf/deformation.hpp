// Vertices that do not stay where they are written: morph targets add to them, then joints carry
// them. In comes what a node's mesh is deformed by; out comes a position a vertex.
#pragma once

#include <Imath/ImathMatrix.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "scene/gltf/accessor.hpp"
#include "scene/gltf/document.hpp"

namespace dapple::gltf {

struct Deformation {
  std::vector<double> weights;  ///< of morph targets; those beyond its end are 0
  /// From the mesh, as it was bound, to the world, a matrix a joint; null: not skinned.
  const std::vector<Imath::M44d>* joints = nullptr;
};

/// Whether a primitive says which joints carry its vertices.
bool has_joints(const tinygltf::Primitive& primitive);

/// What deforming `vertices` of a primitive takes, in numbers read; needs no byte of geometry.
std::uint64_t deformation_cost(const Document& document, const tinygltf::Primitive& primitive,
                               const Deformation& deformation, std::uint64_t vertices);

class VertexDeformer {
 public:
  /// Refers to `deformation` and `who`. Throws Error input, beginning with `who`, for accessors of
  /// a type that glTF does not give them.
  VertexDeformer(const Document& document, const tinygltf::Primitive& primitive,
                 const Deformation& deformation, const std::string& who);

  /// Where vertex `i` is that is written to be at `base`. Throws Error input for a joint that the
  /// skin does not have.
  [[nodiscard]] Imath::V3f position(Imath::V3f base, std::uint64_t i) const;

 private:
  struct Influences {
    AccessorReader joints, weights;  ///< four a vertex
  };

  void read_targets(const Document& document, const tinygltf::Primitive& primitive);
  void read_influences(const Document& document, const tinygltf::Primitive& primitive);
  [[nodiscard]] Imath::V3d carried(const Imath::V3d& position, std::uint64_t i) const;
  [[nodiscard]] const Imath::M44d& joint(const Influences& set, std::uint64_t i,
                                         std::uint64_t k) const;

  const Deformation& deformation_;
  const std::string& file_;
  const std::string& who_;
  std::vector<std::pair<double, AccessorReader>> targets_;
  std::vector<Influences> influences_;
};

/// The matrices of a skin's joints, from where their nodes stand in the world.
std::vector<Imath::M44d> joint_matrices(const Document& document, int skin,
                                        const std::vector<Imath::M44d>& world);

}  // namespace dapple::gltf
