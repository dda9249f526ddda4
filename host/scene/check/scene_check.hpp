// Whether the parts of a scene fit together. Readers make only such scenes; callers of the library
// may make others. In: a scene; out: an error that names the first part that does not fit.
#pragma once

#include <string>

#include "dapple/scene.hpp"

namespace dapple {

/// What messages call the scene.
inline std::string source_name(const Scene& scene) {
  return scene.source.empty() ? "the scene" : scene.source;
}

/// Throws Error input if an index of a mesh, an instance or a material points at nothing, arrays of
/// a mesh or an image have wrong lengths, or a light has numbers that no light has.
void check_scene(const Scene& scene);

/// The same without lights, which a BVH does not depend on, and of lights alone.
void check_geometry(const Scene& scene);
void check_lights(const Scene& scene);

}  // namespace dapple
