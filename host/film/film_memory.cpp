#include "film/film_memory.hpp"

#include <fmt/format.h>

#include "dapple/error.hpp"
#include "film/memory_limit.hpp"
#include "film/sums/film_sums.hpp"

namespace dapple {
namespace {

// RGBA, albedo, ao, error.ao, bent, N, Ng, P, Z, samples
constexpr std::size_t kSurfaceChannels = 25;
constexpr std::size_t kLightChannels = 4;    // light.NAME and error.light.NAME
constexpr std::size_t kMatteChannels = 12;   // of crypto_object or crypto_material
constexpr std::size_t kMatteSlotBytes = 80;  // MatteSums, two slots
constexpr std::size_t kDeepBytes = 200;      // DeepSums and DeepAlpha, eight depths
constexpr std::size_t kPlanBytes = 12;       // PixelWork, the number of samples

}  // namespace

/// All values count twice. Sums are on the device and, unless it shares the host's memory, in the
/// host's copy; channels are in the film and in the file that is being written.
std::size_t film_bytes_per_pixel(std::size_t lights, const RenderOptions& options) {
  const std::size_t squares = 1 + lights;  // of two floats each
  std::size_t sums = DAPPLE_SURFACE_PLANES + DAPPLE_AO_PLANES + DAPPLE_NORMAL_PLANES +
                     DAPPLE_ALBEDO_PLANES + DAPPLE_DOME_PLANES * lights +
                     squares;  // as if all were domes
  std::size_t channels = kSurfaceChannels + kLightChannels * lights;
  if (options.albedo) sums += DAPPLE_REFLECTED_PLANES * (1 + lights);
  if (options.beauty) channels += 3 * (1 + lights);
  if (options.back) {
    sums += DAPPLE_BACK_PLANES + 1 + DAPPLE_DOME_CHANNELS * lights;  // 1: AO
    channels += 3 * (1 + lights);
  }
  if (options.motion) {
    sums += 2;
    channels += 2;
  }
  if (options.visits) channels += 2;
  const std::size_t sides = options.back ? 2 : 1;
  const std::size_t differences = options.report_bias > 0 ? sides * (1 + lights) : 0;  // BiasSums
  const std::size_t deep = options.deep ? kDeepBytes : 0;
  const Cryptomattes& mattes = options.cryptomattes;
  const std::size_t types = (mattes.objects ? 1u : 0u) + (mattes.materials ? 1u : 0u);
  return 2 * (sums * sizeof(std::int64_t) + channels * sizeof(float)) +
         types * (2 * kMatteChannels * sizeof(float)) + (types ? kMatteSlotBytes : 0) + deep +
         differences * sizeof(float) + kPlanBytes;
}

void check_film_memory(const View& view, std::size_t light_count, const RenderOptions& options) {
  constexpr double kGigabyte = 1e9;
  const double needs = static_cast<double>(view.crop.width()) * view.crop.height() *
                       static_cast<double>(film_bytes_per_pixel(light_count, options));
  const double has = machine_bytes();
  if (needs <= has / 2 || has <= 0) return;
  throw Error(
      ErrorKind::usage,
      fmt::format("--width {} --height {}: the image takes {:.1f} GB with {} light{}, and this "
                  "machine has {:.1f} GB; make it smaller, or render parts with --crop{}",
                  view.width, view.height, needs / kGigabyte, light_count,
                  light_count == 1 ? "" : "s", has / kGigabyte,
                  light_count == 0 ? "" : ", or fewer lights with --lights or --passes ao"));
}

void check_film_buffer(const DeviceInfo& device, const View& view, const std::vector<Light>& lights,
                       const RenderOptions& options, const std::function<bool()>& is_smooth) {
  const auto bytes = [&](bool has_normals) {
    const FilmScales scales{1, 1, std::vector<float>(lights.size(), 1.0f)};
    return FilmLayout(view.crop, options, scales, lights, has_normals).sum_bytes();
  };
  const bool shading = options.normals == Normals::shading;
  std::size_t needed = bytes(shading);
  if (needed > device.largest_buffer_bytes && shading && !is_smooth()) needed = bytes(false);
  if (needed <= device.largest_buffer_bytes) return;
  throw Error(
      ErrorKind::device,
      fmt::format("the sums of {} x {} pixels with {} light{} take {} bytes in one buffer, {} "
                  "gives {} at most; render a smaller image or parts with --crop, fewer lights "
                  "with --lights, fewer --passes, or on another --device",
                  view.crop.width(), view.crop.height(), lights.size(),
                  lights.size() == 1 ? "" : "s", needed, device.name, device.largest_buffer_bytes));
}

}  // namespace dapple
