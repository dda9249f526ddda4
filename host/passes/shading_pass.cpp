#include "passes/shading_pass.hpp"

#include <algorithm>

#include "dapple/error.hpp"
#include "passes/ray_packets.hpp"

namespace dapple {

namespace {

/// A colour averages the shares of so many samples, at most the pixel: as opacities do with taps.
constexpr int kColorSamples = 6;

/// `resolves`: add colours and normals of the points to the film.
void shade(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
           const FilmBuffers& film, bool resolves, const ResolveParams& params,
           const Viewpoint& from, int spp) {
  ShadingParams shading{};
  shading.resolve = params;
  shading.viewpoint = from;
  shading.normals = scene.corner_normals.empty() ? 0u : 1u;
  shading.albedo = scene.uploaded.colors && resolves ? 1u : 0u;
  shading.resolves = resolves ? 1u : 0u;
  shading.color_share = static_cast<float>(std::min(kColorSamples, std::max(spp, 1)));
  shading.segment_words = static_cast<uint>(scene.block_values.size());
  const std::size_t items_of_pixel = traces_scalar(context) ? DAPPLE_SHADING_ITEMS : 1;
  context.launch(shading_kernel(context), "shading", params.slice.pixel_count * items_of_pixel,
                 {scene.nodes, scene.blocks, scene.textured, scene.instances, scene.normals,
                  scene.color_words, scene.color_materials, scene.color_texels, queues.work,
                  queues.points, queues.sample_hits, queues.albedo, film.sums, shading},
                 kRayGroup);
}

}  // namespace

KernelName shading_kernel(const DeviceContext& context) {
  if (traces_scalar(context)) return {"shade_points_scalar", "shading/shade_points_scalar", {}};
  return {"shade_points", "shading/shade_points", {}};
}

void shading_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                  const FilmBuffers& film, const ResolveParams& params, const Viewpoint& from,
                  int spp) {
  if (queues.albedo.bytes() > 0 && !scene.uploaded.colors)
    throw Error(ErrorKind::usage, "albedo needs a scene that is uploaded with colors");
  shade(context, scene, queues, film, true, params, from, spp);
}

void move_points_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                      const Viewpoint& from, std::size_t samples) {
  // A work-item for each record, as if it were a pixel.
  ResolveParams params{};
  params.slice.pixel_count = static_cast<uint>(hit_records(samples));
  params.slice.sample_count = DAPPLE_HIT_BITS;
  const FilmBuffers none{context.allocate(0), context.allocate(0)};
  shade(context, scene, queues, none, false, params, from, 1);
}

}  // namespace dapple
