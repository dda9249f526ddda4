// The view of a picture: a camera and the pixels to render. In: scene and options. Out: the view,
// parameters of the camera kernel, matrices for EXR.
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <optional>
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

/// The view that `options` describe. If `options` choose no camera and the scene does not have
/// exactly one, adds to `notes` which camera was taken. Throws Error usage when a named camera is
/// not in the scene, listing those that are.
View choose_view(const Scene& scene, const RenderOptions& options, std::vector<std::string>& notes);

/// The camera kernel's parameters without `slice` and `scene`; `bounds` are the scene's, world
/// space.
CameraParams camera_params(const View& view, const RenderOptions& options, const Box3f& bounds);

/// Where the surface points of a picture are seen from.
Viewpoint viewpoint(const View& view);

/// How a camera ray averages textures; the fields are those of CameraParams. Zeros: it does not.
struct TexelFootprint {
  float share = 0, tap_offset = 0, tap_centring = 0;
  /// Area, in pixels, of the square in which uniform points have the variance of the lookups.
  float spread = 0;
};

/// For footprints of `spp` samples a pixel. Without camera splitting there are no filter taps: they
/// make opacities between 0 and 1, which need several thresholds a ray, and with only one the edges
/// of leaves would be noisier.
TexelFootprint texel_footprint(const RenderOptions& options, int spp);

/// Where points are in the image.
class Projection {
 public:
  explicit Projection(const View& view);
  /// Pixels from the top left at which the ray through the middle of the lens passes `at` (world
  /// space); none: `at` is not in front of a perspective camera.
  [[nodiscard]] std::optional<Imath::V2d> operator()(const V3d& at) const;
  bool operator==(const Projection&) const = default;

 private:
  Imath::M44d to_camera_;
  Imath::V2d pixels_;  ///< of half the image, by the half extent of the image plane
  Imath::V2d middle_;  ///< of the image, pixels
  bool perspective_;
};

/// Width of a pixel at the distance of `at`, a point in world space; metres.
float pixel_width(const View& view, const V3f& at);

/// World to EXR's camera space: left-handed, x right, y up, +Z forward; row vectors.
M44f world_to_exr_camera(const Camera& camera);

/// World to EXR's NDC: x right, y down, (0,0) to (1,1) over the display window, after
/// division by w.
M44f world_to_ndc(const View& view);

}  // namespace dapple
