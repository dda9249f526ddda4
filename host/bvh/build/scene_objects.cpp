#include "bvh/build/scene_objects.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <chrono>

#include "bvh/storage/object_key.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Objects with fewer triangles are not cached (experiment 102).
constexpr std::size_t kMinCachedTriangles = 256;

/// The state of a mesh while its object is read or built.
struct Work {
  bool is_cached = false;  ///< large enough for a file
  bool is_read = false;
  Checksum key{};
  std::string note;  ///< the error of its cache file
  BuiltObject built;
  CachedObject finished;
};

/// Calls `body` for every item, in parallel. Returns wall seconds.
template <class Body>
double for_each(std::vector<Work>& works, const Body& body) {
  const auto start = std::chrono::steady_clock::now();
  tbb::parallel_for(std::size_t{0}, works.size(), [&](std::size_t m) { body(works[m], m); });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void read_from_cache(const Scene& scene, const std::string& folder, std::vector<Work>& works,
                     BvhStatistics& statistics) {
  statistics.cache.read_seconds = for_each(works, [&](Work& work, std::size_t m) {
    const Mesh& mesh = scene.meshes[m];
    work.is_cached = mesh.primitive_count() >= kMinCachedTriangles;
    if (!work.is_cached) return;
    work.key = object_key(scene, mesh);
    auto found = read_cached_object(folder, work.key, scene, work.note);
    work.is_read = found.has_value();
    if (found) work.finished = std::move(*found);
  });
}

/// Builds and prefilters the objects that were not read. Fills `records`, one for each mesh, unless
/// it is nullptr.
void build_missing(const Scene& scene, std::vector<Work>& works, BvhStatistics& statistics,
                   std::vector<RefitRecord>* records) {
  const OpaqueTexels texels(scene);
  statistics.build_seconds = for_each(works, [&](Work& work, std::size_t m) {
    if (work.is_read) return;
    if (records) (*records)[m] = {};
    const Mesh& mesh = scene.meshes[m];
    work.built = build_object(scene, texels, mesh);
  });
  SharedMipLevels mip_levels(scene);
  statistics.prefilter_seconds = for_each(works, [&](Work& work, std::size_t m) {
    if (work.is_read) return;
    ObjectBvh& object = work.built.object;
    if (!object.nodes.empty()) {
      prefilter(work.built, TextureIntegrals(scene, object.textured, mip_levels),
                records && !object.has_strands ? &(*records)[m] : nullptr);
    }
    work.finished.object = FinishedObject(std::move(object));
    work.built = {};
  });
}

/// Divides the build time over the objects by their numbers of triangles.
void share_out_seconds(std::vector<Work>& works, const BvhStatistics& statistics) {
  double triangles = 0;
  for (const Work& work : works) {
    if (!work.is_read) triangles += static_cast<double>(work.finished.object.primitive_count);
  }
  for (Work& work : works) {
    if (work.is_read || work.finished.object.primitive_count == 0) continue;
    work.finished.build_seconds = (statistics.build_seconds + statistics.prefilter_seconds) *
                                  static_cast<double>(work.finished.object.primitive_count) /
                                  triangles;
  }
}

/// Writes the new objects. If a cache file cannot be written, the error becomes a note, and the
/// render continues.
void write_to_cache(const std::string& folder, std::vector<Work>& works,
                    BvhStatistics& statistics) {
  std::vector<char> written(works.size(), 0);
  statistics.cache.write_seconds = for_each(works, [&](Work& work, std::size_t m) {
    if (!work.is_cached || work.is_read || work.finished.object.nodes.empty()) return;
    try {
      write_cached_object(folder, work.key, work.finished);
      written[m] = 1;
    } catch (const Error& error) {
      work.note = error.what();
    }
  });
  for (const char was_written : written) statistics.cache.objects_written += was_written != 0;
}

/// Returns one line for the notes of all files.
std::string summed_notes(const std::vector<Work>& works) {
  std::string first;
  std::size_t count = 0;
  for (const Work& work : works) {
    if (work.note.empty()) continue;
    if (count++ == 0) first = work.note;
  }
  if (count < 2) return first;
  return fmt::format("{} (and {} more files)", first, count - 1);
}

void add_cache_statistics(const std::vector<Work>& works, BvhStatistics& statistics) {
  for (const Work& work : works) {
    if (!work.is_read) continue;
    ++statistics.cache.objects_read;
    statistics.cache.seconds_saved += work.finished.build_seconds;
  }
  statistics.cache.note = summed_notes(works);
  if (statistics.cache.objects_read == 0) return;
  statistics.cache.seconds_saved -= statistics.cache.read_seconds;
}

std::vector<FinishedObject> finished_of(std::vector<Work>& works) {
  std::vector<FinishedObject> objects;
  for (Work& work : works) objects.push_back(std::move(work.finished.object));
  return objects;
}

}  // namespace

std::vector<FinishedObject> finish_objects(const Scene& scene, const std::string& cache_folder,
                                           BvhStatistics& statistics) {
  std::vector<Work> works(scene.meshes.size());
  if (!cache_folder.empty()) read_from_cache(scene, cache_folder, works, statistics);
  build_missing(scene, works, statistics, nullptr);
  if (!cache_folder.empty()) {
    share_out_seconds(works, statistics);
    write_to_cache(cache_folder, works, statistics);
    add_cache_statistics(works, statistics);
  }
  return finished_of(works);
}

std::vector<FinishedObject> build_refittable(const Scene& scene, std::vector<FinishedObject> kept,
                                             const std::vector<bool>& is_kept,
                                             std::vector<RefitRecord>& records,
                                             BvhStatistics& statistics) {
  std::vector<Work> works(scene.meshes.size());
  for (std::size_t m = 0; m < works.size(); ++m) {
    works[m].is_read = is_kept[m];
    if (is_kept[m]) works[m].finished.object = std::move(kept[m]);
  }
  records.resize(works.size());
  build_missing(scene, works, statistics, &records);
  return finished_of(works);
}

}  // namespace dapple
