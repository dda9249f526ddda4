// A scene laid out as a GLB file: the JSON text, and the pieces of memory that make up the
// binary chunk after it. In: a scene; out: what glb_writer.cpp puts on disk.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// The binary chunk, in order. Pieces point into the scene or into `made`.
struct GlbLayout {
  std::string json;
  std::vector<std::span<const std::byte>> sections;
  std::size_t byte_count = 0;  ///< of all pieces; a multiple of 4
  std::vector<std::vector<std::uint32_t>> made_indices;
  std::vector<std::vector<float>> made_colours;
};

/// The scene must outlive the layout. Throws Error failed on vertices that are not finite,
/// which glTF cannot hold.
GlbLayout lay_out_glb(const Scene& scene);

}  // namespace dapple
