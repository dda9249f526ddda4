// The BVH of a scene, with the summaries and offsets of the objects, which the joined arrays do not
// contain.
#pragma once

#include <string>
#include <vector>

#include "bvh/build/joined_objects.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

struct BuiltScene {
  SceneBvh bvh;
  std::vector<ObjectSummary> objects;  ///< of each mesh
  std::vector<ObjectOffsets> offsets;  ///< lay_out()
};

/// Like build_bvh(), and returns the objects too.
BuiltScene build_scene(const Scene& scene, const std::string& cache_folder);

}  // namespace dapple
