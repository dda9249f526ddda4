// Makes the finished object of every mesh: reads it from the cache, or builds it and writes it to
// the cache.
#pragma once

#include <string>
#include <vector>

#include "bvh/refit/refit_record.hpp"
#include "bvh/storage/bvh_cache.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

/// Returns one object for each mesh; meshes without primitives that can be hit have no nodes. Fills
/// the times and the cache's part of the statistics. `cache_folder`: empty for none.
std::vector<FinishedObject> finish_objects(const Scene& scene, const std::string& cache_folder,
                                           BvhStatistics& statistics);

/// The same without a cache. The objects and records of meshes marked `is_kept` stay as they are;
/// for the other meshes the function builds objects and fills `records` for refitting.
std::vector<FinishedObject> build_refittable(const Scene& scene, std::vector<FinishedObject> kept,
                                             const std::vector<bool>& is_kept,
                                             std::vector<RefitRecord>& records,
                                             BvhStatistics& statistics);

}  // namespace dapple
