#include "render/slice_params.hpp"

#include <algorithm>
#include <bit>

#include "camera/camera_splitting.hpp"
#include "render/trace_state.hpp"

namespace dapple {
namespace {

/// Rays of one kind in a slice. On a CPU the queues stay in its caches, and passes are long enough
/// that their ends do not matter (experiment 706).
constexpr std::size_t kCpuSlice = 1u << 18;

/// The same for each compute unit of a GPU, so that launches are long beside the waits between
/// them.
constexpr std::size_t kSliceOfUnit = 1u << 17;

/// Bytes of device memory for each ray of a GPU's slice: the queues take some hundreds of bytes a
/// ray, and the scene must have room beside them.
constexpr std::size_t kMemoryOfRay = 2048;

/// Slices of a picture at least, if they are no smaller than on a CPU: a render tells its progress
/// and stops between slices.
constexpr std::size_t kSlicesOfPicture = 8;

/// Rays of all kinds in a slice at most, as a multiple of the above: with many lights a slice would
/// take too long, and a render stops only between slices.
constexpr std::size_t kRaysOverInFlight = 4;

/// Camera rays of a pixel that targets usually take.
constexpr int kUsualSpp = 64;

std::size_t rays_of_slice(const DeviceInfo& device, std::size_t camera_rays) {
  if (device.kind == "CPU") return kCpuSlice;
  const std::size_t rays =
      std::min({kSliceOfUnit * device.compute_units, device.memory_bytes / kMemoryOfRay,
                camera_rays / kSlicesOfPicture, std::size_t{kMaxSliceSamples}});
  return std::max(kCpuSlice, std::bit_floor(rays));
}

}  // namespace

std::uint32_t samples_of_slice(const DeviceInfo& device, const RenderOptions& options,
                               std::size_t lights, std::size_t rays_in_flight, std::size_t pixels) {
  // With a target pixels take more than the least number of samples.
  const int spp = is_adaptive(options) ? std::max(options.spp, std::min(options.max_spp, kUsualSpp))
                                       : options.spp;
  const std::size_t slice = rays_of_slice(device, pixels * static_cast<std::size_t>(spp));
  const std::size_t rays = 1 + static_cast<std::size_t>(options.ao ? options.ao_rays : 0) +
                           lights * static_cast<std::size_t>(options.light_rays);
  const std::size_t samples = std::min(slice / rays_in_flight, kRaysOverInFlight * slice / rays);
  return std::max(DAPPLE_SAMPLE_BATCH, static_cast<uint>(samples));
}

ResolveParams resolve_params(const View& view, const FilmLayout& layout, uint splitting_bits) {
  ResolveParams params{};
  params.film_pixels = layout.pixels;
  params.splitting_bits = splitting_bits;
  params.position_scale = layout.position_scale;
  params.depth_scale = layout.depth_scale;
  const M44f& m = view.camera.to_world;
  for (int axis = 0; axis < 3; ++axis) {
    params.axis[axis] = -m[2][axis];
    params.eye[axis] = m[3][axis];
  }
  return params;
}

unsigned back_group(const RenderOptions& options) {
  // With a target, quiet pixels have as few as two batches, whatever their number for footprints.
  const auto samples =
      is_adaptive(options)
          ? 2 * DAPPLE_SAMPLE_BATCH
          : static_cast<unsigned>(footprint_samples(options) * splitting_factor(options));
  return std::bit_floor(std::min(static_cast<unsigned>(options.back_every), samples));
}

BackParams back_params(const View& view, const RenderOptions& options, const FilmLayout& layout,
                       const ResolveParams& resolve) {
  BackParams params{};
  params.resolve = resolve;
  params.resolve.plane = layout.back_samples;
  params.group_bits = static_cast<uint>(std::countr_zero(back_group(options)));
  params.seed = options.seed;
  params.width = static_cast<uint>(view.width);
  params.crop_x = static_cast<uint>(view.crop.x0);
  params.crop_y = static_cast<uint>(view.crop.y0);
  params.crop_width = static_cast<uint>(view.crop.width());
  return params;
}

}  // namespace dapple
