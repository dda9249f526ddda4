#include "render/kept_scene.hpp"

#include <algorithm>

#include "render/stopwatch.hpp"

namespace dapple {
namespace {

void add_cache_statistics(RenderStatistics& s, const BvhStatistics& bvh) {
  s.cache.used = true;
  s.cache.objects_read = bvh.cache.objects_read;
  s.cache.objects_written = bvh.cache.objects_written;
  s.cache.seconds_saved = bvh.cache.seconds_saved;
  s.seconds.cache = bvh.cache.read_seconds + bvh.cache.write_seconds;
  if (!bvh.cache.note.empty()) s.notes.push_back("BVH cache: " + bvh.cache.note);
}

void add_build_seconds(RenderStatistics& s, const BvhStatistics& bvh) {
  s.seconds.build += bvh.build_seconds + bvh.instance_seconds;
  s.seconds.prefilter += bvh.prefilter_seconds;
}

void add_update_statistics(RenderStatistics& s, const BvhUpdate& update, const BvhStatistics& bvh) {
  double built = 0;
  if (update.objects_rebuilt > 0) {
    add_build_seconds(s, bvh);
    built = bvh.build_seconds + bvh.instance_seconds + bvh.prefilter_seconds;
  }
  s.seconds.refit += std::max(0.0, update.seconds - built);
  s.refit = {true, update.objects_kept, update.objects_refitted, update.objects_rebuilt,
             update.cost_ratio};
}

void add_bvh_statistics(RenderStatistics& s, const SceneBvh& bvh, const DeviceBuffers& buffers) {
  s.triangles = bvh.statistics.triangles;
  s.segments = bvh.statistics.segments;
  s.nodes = bvh.nodes.size();
  s.bytes.nodes = buffers.nodes.bytes();
  s.bytes.triangles = buffers.blocks.bytes() + buffers.textured.bytes() + buffers.normals.bytes() +
                      buffers.color_words.bytes();
  s.bytes.segments = buffers.segments.bytes();
  s.bytes.textures = buffers.texels.bytes() + buffers.materials.bytes() +
                     buffers.color_texels.bytes() + buffers.color_materials.bytes();
  s.bytes.instances = buffers.instances.bytes();
}

/// Whether the options would open the device as it was opened.
bool is_named(const Device& device, const RenderOptions& options) {
  const DeviceContext& opened = device.context();
  return opened.chosen_by() == options.device && opened.kernel_dir() == options.kernel_dir &&
         opened.packets() == options.packets;
}

}  // namespace

void KeptScene::use(const Device& opened) {
  loader.reset();  // before the device
  *this = {};
  device = opened;
  loader = std::make_unique<KernelLoader>(device->context());
}

void KeptScene::open(const RenderOptions& options, RenderStatistics& statistics) {
  if (!device || !is_named(*device, options))
    use(Device(options.device, options.kernel_dir, options.packets));
  statistics.device = device->info().name;
  for (std::string& note : device->context().notes()) statistics.notes.push_back(std::move(note));
}

void KeptScene::update_scene(const Scene& scene, const UploadOptions& uploading,
                             const std::string& cache, RenderStatistics& statistics) {
  const Stopwatch updating;
  const double before = counted_seconds(statistics);
  if (bvh) {
    const BvhUpdate changes = update(*device, on_device, *bvh, scene, uploading);
    add_update_statistics(statistics, changes, bvh->bvh().statistics);
    statistics.seconds.upload += updating.seconds() - changes.seconds;
  } else {
    bvh.emplace(scene, UpdatableBvh::Motion::maybe, cache);
    const BvhStatistics& built = bvh->bvh().statistics;
    add_build_seconds(statistics, built);
    if (!cache.empty()) add_cache_statistics(statistics, built);
    statistics.seconds.build += updating.seconds() - (counted_seconds(statistics) - before);
    const Stopwatch upload_time;
    on_device = upload(*device, scene, bvh->bvh(), uploading);
    statistics.seconds.upload = upload_time.seconds();
  }
  add_bvh_statistics(statistics, bvh->bvh(), *on_device.buffers);
}

double counted_seconds(const RenderStatistics& statistics) {
  const auto& s = statistics.seconds;
  return s.load + s.prepare + s.cache + s.build + s.prefilter + s.refit + s.upload +
         s.kernel_build + s.trace + s.checkpoint + s.develop + s.write;
}

void KeptScene::compile(const std::vector<KernelName>& kernels, CompilerProcesses& processes,
                        RenderStatistics& statistics) const {
  const Stopwatch compiling;
  loader->wait();
  processes.wait();
  for (const KernelName& kernel : kernels) device->context().prepare(kernel);
  statistics.seconds.kernel_build = compiling.seconds();
}

}  // namespace dapple
