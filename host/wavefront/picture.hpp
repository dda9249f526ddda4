// Tracing one picture, slice by slice, into its film sums.
#pragma once

#include "dapple/wavefront.hpp"
#include "device/scene_upload.hpp"
#include "wavefront/film_sums.hpp"

namespace dapple {

struct TracedPicture {
  std::vector<std::int64_t> sums;      ///< as FilmLayout says
  std::vector<std::uint32_t> samples;  ///< of each pixel
  /// With a target error: standard errors by pass (AO, then the lights, these relative to their
  /// largest unoccluded irradiance) and pixel.
  std::vector<std::vector<float>> errors;
  std::size_t queue_bytes = 0;
};

/// Runs every pass that `options` ask for over the view's crop. The result depends on
/// neither the slices nor the device's threads.
TracedPicture trace_picture(const Device& device, const DeviceScene& scene, const View& view,
                            const RenderOptions& options, const FilmLayout& layout,
                            std::size_t light_count, const Progress& progress);

}  // namespace dapple
