// What the hits of camera rays belong to. In: a scene after merge_single_instances(), and its BVH.
// Out: numbers of an object and a material for an instance and a primitive.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/bvh.hpp"
#include "dapple/options.hpp"
#include "dapple/scene.hpp"

namespace dapple {

class MatteLookup {
 public:
  struct Ids {
    std::uint32_t object = 0, material = 0;
  };

  /// The scene must have been through name_objects() before it was merged. What is not `wanted`
  /// has the number 0, so that it does not divide the samples of what is.
  MatteLookup(const Scene& scene, const SceneBvh& bvh, Cryptomattes wanted);

  /// Of a hit that the camera pass kept for the shading pass. Not of a hit in a medium.
  [[nodiscard]] Ids at(std::uint32_t instance, std::uint32_t primitive) const;

 private:
  Cryptomattes wanted_;
  std::vector<Ids> triangles_, segments_;        ///< by lane; object kOfInstance: the instance's
  std::vector<std::uint32_t> instance_objects_;  ///< by InstanceRecord
};

}  // namespace dapple
