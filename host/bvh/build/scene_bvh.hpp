// A built scene with the objects and offsets that its joined arrays no longer show.
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

/// As build_bvh().
BuiltScene build_scene(const Scene& scene, const std::string& cache_folder);

}  // namespace dapple
