// Every mesh's finished object: from the cache, or built and put into it.
#pragma once

#include <string>
#include <vector>

#include "bvh/refit/refit_record.hpp"
#include "bvh/storage/bvh_cache.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

/// One for each of the scene's meshes; those that nothing can hit have no nodes. Fills what the
/// statistics tell of times and of the cache. `cache_folder`: empty for none.
std::vector<FinishedObject> finish_objects(const Scene& scene, const std::string& cache_folder,
                                           BvhStatistics& statistics);

/// The same without a cache, but for the meshes marked `is_kept`, whose objects and records stay as
/// they are. Fills the other meshes' records for refitting.
std::vector<FinishedObject> build_refittable(const Scene& scene, std::vector<FinishedObject> kept,
                                             const std::vector<bool>& is_kept,
                                             std::vector<RefitRecord>& records,
                                             BvhStatistics& statistics);

}  // namespace dapple
