// What an edit of a primitive means for its KHR_draco_mesh_compression data. In: a primitive of an
// Editor. Out: the same, which compressed data do not contradict.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/edit/editor.hpp"

namespace dapple::gltf {

/// Takes an attribute, which the primitive has anew, out of those that are compressed; they are as
/// many as before, and in the same order. If none is left, the primitive is compressed no longer.
/// Returns whether that is so.
bool leave_out_of_compressed(Editor& editor, std::uint32_t mesh, std::uint32_t primitive,
                             const std::string& name);

/// Returns the accessor that has the elements of `index`, an attribute of a primitive in the
/// Editor's JSON: another one of the document if they are compressed.
int decoded_accessor(const Editor& editor, std::uint32_t mesh, std::uint32_t primitive,
                     const std::string& name, int index);

/// Adds an accessor of indices, as short as the number of vertices lets them be.
std::size_t add_indices(Editor& editor, const std::vector<std::uint32_t>& indices,
                        std::size_t vertices);

}  // namespace dapple::gltf
