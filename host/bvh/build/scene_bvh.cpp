// Builds all objects' BVHs, joins them, and builds the top-level BVH over their instances.
#include "bvh/build/scene_bvh.hpp"

#include "bvh/build/scene_objects.hpp"
#include "bvh/build/top_level.hpp"
#include "scene/check/scene_check.hpp"

namespace dapple {

BuiltScene build_scene(const Scene& scene, const std::string& cache_folder) {
  check_scene(scene);
  if (!cache_folder.empty()) prepare_bvh_cache(cache_folder);
  BuiltScene built;
  SceneBvh& bvh = built.bvh;
  std::vector<FinishedObject> objects = finish_objects(scene, cache_folder, bvh.statistics);
  built.offsets = lay_out(objects, scene.source);
  built.objects.assign(objects.begin(), objects.end());
  describe_objects(bvh.statistics, built.objects);
  LargeVector<BvhNode> top = place_instances(bvh, scene, built.objects, built.offsets);
  join(bvh, objects, built.offsets, std::move(top));
  bvh.statistics.lane_use = lane_use(bvh);
  return built;
}

SceneBvh build_bvh(const Scene& scene, const std::string& cache_folder) {
  return build_scene(scene, cache_folder).bvh;
}

}  // namespace dapple
