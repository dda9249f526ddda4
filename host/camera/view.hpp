// From which camera, and through which pixels.
#pragma once

#include <string>
#include <vector>

#include "dapple/film.hpp"
#include "dapple/options.hpp"
#include "dapple/shared/pass_params.h"

namespace dapple {

struct View {
  Camera camera;
  int width = 0, height = 0;
  PixelRect crop;
  [[nodiscard]] std::uint32_t pixel_count() const {
    return static_cast<std::uint32_t>(crop.width()) * static_cast<std::uint32_t>(crop.height());
  }
};

/// The camera that `options` ask for; adds to `notes` when one had to be made up. Throws
/// Error usage when a named camera is not in the scene, listing those that are.
View choose_view(const Scene& scene, const RenderOptions& options, std::vector<std::string>& notes);

/// What the camera kernel needs, but for the slice and the scene; `bounds` are the scene's.
CameraParams camera_params(const View& view, const RenderOptions& options, const Box3f& bounds);

/// How a camera ray averages textures, as CameraParams has it; zeros: not at all.
struct TexelFootprint {
  float share = 0, tap_offset = 0, tap_centring = 0;
  float spread = 0;  ///< of a pixel's area, a square over which places spread as far
};

/// Where footprints are made for `spp` samples a pixel. With one depth there are no taps: opacities
/// between 0 and 1 take thresholds, of which there are too few then, and edges would be noisier.
TexelFootprint texel_footprint(const RenderOptions& options, int spp);

/// In metres, of a pixel at a place.
float pixel_width(const View& view, const V3f& at);

/// World to EXR's camera space: left-handed, x right, y up, +Z forward; row vectors.
M44f world_to_exr_camera(const Camera& camera);

/// World to EXR's NDC: x right, y down, (0,0) to (1,1) over the display window, after
/// division by w.
M44f world_to_ndc(const View& view);

}  // namespace dapple
