#include "camera/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "scene/check/finite.hpp"
#include "scene/check/scene_check.hpp"

namespace dapple {
namespace {

float radians(float degrees) { return degrees * std::numbers::pi_v<float> / 180.0f; }

Camera named_camera(const Scene& scene, const std::string& name) {
  std::string list;
  for (const Camera& camera : scene.cameras) {
    if (camera.name == name) return camera;
    list += (list.empty() ? "" : ", ") + camera.name;
  }
  throw Error(ErrorKind::usage,
              fmt::format("--camera {}: {} has {}", name, scene.source,
                          list.empty() ? "no cameras" : "only these cameras: " + list));
}

Camera choose_camera(const Scene& scene, const RenderOptions& options,
                     std::vector<std::string>& notes) {
  if (options.look) {
    const float fov = options.fov_degrees > 0 ? options.fov_degrees : 40.0f;
    return look_at(options.look->from, options.look->at, options.look->up, radians(fov));
  }
  if (!options.camera.empty()) return named_camera(scene, options.camera);
  if (!scene.cameras.empty()) {
    if (scene.cameras.size() > 1) {
      notes.push_back(
          fmt::format("camera: {}, the first of {}", scene.cameras[0].name, scene.cameras.size()));
    }
    return scene.cameras[0];
  }
  notes.emplace_back(
      "no camera in the scene: added one that shows all of it; --look-from and --look-at choose "
      "another");
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  return options.fov_degrees > 0 ? frame_scene(scene, aspect, radians(options.fov_degrees))
                                 : frame_scene(scene, aspect);
}

/// Half width and half height of the image plane: of perspective cameras at distance 1, of
/// orthographic ones in metres.
V2f half_extent(const View& view) {
  const float aspect = static_cast<float>(view.width) / static_cast<float>(view.height);
  const bool orthographic = view.camera.kind == Camera::Kind::orthographic;
  const float half = orthographic ? view.camera.half_height : std::tan(0.5f * view.camera.fov_y);
  return {half * aspect, half};
}

/// Margin around the scene's bounds, relative to the largest coordinate: more than the distance by
/// which rounding can move a surface.
constexpr double kBoundsMargin = 1e-5;

/// Radius on the image plane of half_extent() of the disk that a point at that depth becomes.
double circle_of_confusion(const Camera& camera, double depth) {
  if (camera.lens_radius == 0) return 0;
  const double focus = camera.focus_distance;
  return camera.lens_radius * std::fabs(camera.kind == Camera::Kind::orthographic
                                            ? 1 - depth / focus
                                            : 1 / depth - 1 / focus);
}

/// The rectangle of the picture that contains the projected corners of the scene's bounds, in
/// pixels from the top left, with their circles of confusion. Infinite when a corner is not in
/// front of the camera.
Imath::Box2d picture_bounds(const View& view, const Box3f& bounds) {
  Imath::Box2d everywhere(Imath::V2d(-std::numeric_limits<double>::infinity()),
                          Imath::V2d(std::numeric_limits<double>::infinity()));
  const Imath::M44d to_world(view.camera.to_world);
  if (!(std::fabs(to_world.determinant()) > 0)) return everywhere;
  const Imath::M44d to_camera = to_world.inverse();
  const Imath::V2d half(half_extent(view));
  const V3d low(bounds.min), high(bounds.max);
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    largest = std::max(
        {largest, std::fabs(low[axis]), std::fabs(high[axis]), std::fabs(to_world[3][axis])});
  }
  const double margin = kBoundsMargin * largest;
  Imath::Box2d seen;
  for (int corner = 0; corner < 8; ++corner) {
    V3d at;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = corner >> axis & 1 ? high[axis] + margin : low[axis] - margin;
    at *= to_camera;
    const double blur = circle_of_confusion(view.camera, -at.z);
    if (view.camera.kind == Camera::Kind::perspective) {
      if (!(-at.z > margin)) return everywhere;
      at /= -at.z;
    }
    for (const double offset : {-blur, blur}) {
      const Imath::V2d pixel(((at.x + offset) / half.x + 1) / 2 * view.width,
                             (1 - (at.y + offset) / half.y) / 2 * view.height);
      if (!std::isfinite(pixel.x) || !std::isfinite(pixel.y)) return everywhere;
      seen.extendBy(pixel);
    }
  }
  return seen;
}

/// The pixel that contains the coordinate `at`, clamped to [0, count].
uint pixel_at(double at, int count) {
  return static_cast<uint>(std::clamp(at, 0.0, static_cast<double>(count)));
}

/// Sets the pixels in which the scene may be: picture_bounds() and one more pixel on each side.
void set_seen(const View& view, const Box3f& bounds, CameraParams& params) {
  const Imath::Box2d seen = picture_bounds(view, bounds);
  params.seen_left = pixel_at(seen.min.x - 1, view.width);
  params.seen_above = pixel_at(seen.min.y - 1, view.height);
  params.seen_right = pixel_at(seen.max.x + 2, view.width);
  params.seen_below = pixel_at(seen.max.y + 2, view.height);
}

/// Part of a camera sample's footprint that one texture lookup averages: without filter taps, and
/// as one of four filter taps.
constexpr float kTexelShare = 0.25f, kTexelShareOfTap = 0.175f;

/// Part of a camera sample's footprint that the four filter taps cover together: experiments 402,
/// 446, 448 and 449.
constexpr float kTapShare = 0.16f;

/// With filter taps, the maximum part of a pixel's area that one lookup averages, and that the four
/// taps cover together, however large footprints are.
constexpr float kMaxTexelShare = 0.25f, kMaxTapShare = 0.75f;

/// Variances along one axis, relative to the variance of uniform points in a square of area 1: of
/// four taps in the middle of its quarters, and of a bilinear lookup in the mip level whose texels
/// are no larger than it. (Texel widths are powers of two, so the texel's area has a mean of 0.54.)
constexpr float kTapVariance = 0.75f, kTexelVariance = 1.6f;

/// Part of footprint_rmse() by which the opacity of one medium's box may deviate in a pixel. A ray
/// may cross several such boxes; but AO deviates by only a part of it, because the inside of a
/// medium is hardly occluded.
constexpr float kMediumError = 0.5f;

/// CameraParams::medium_error. It is 0, which means no media, in exact mode; without a target,
/// since no tolerance is given then; and with lights, whose errors are relative to the largest
/// irradiance, of which media receive little.
float medium_error(const RenderOptions& options) {
  const bool exact = options.estimator == Estimator::exact || options.footprint == 0;
  if (exact || options.light || !is_adaptive(options)) return 0;
  return kMediumError * footprint_rmse(options);
}

}  // namespace

namespace {

/// The distance along the view direction of `at`, metres.
float view_depth(const Camera& camera, const V3f& at) {
  const V3f forward(-camera.to_world[2][0], -camera.to_world[2][1], -camera.to_world[2][2]);
  return (at - camera.to_world.translation()).dot(forward);
}

/// Refuses numbers that no camera has. Files have none of these.
void check_camera(const Scene& scene, const Camera& camera) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorKind::input,
                fmt::format("{}: camera \"{:.100}\" has {}", source_name(scene), camera.name, why));
  };
  const auto that = [&](bool holds, const char* what, float value, const char* range) {
    if (!holds) refuse(fmt::format("the {} {}; it must be {}", what, value, range));
  };
  if (!is_finite(camera.to_world)) refuse("a place that is not finite");
  // In doubles: products of three small scales vanish in floats.
  const double volume = Imath::M44d(camera.to_world).determinant();
  that(volume != 0, "determinant", static_cast<float>(volume), "other than 0");
  that(camera.kind == Camera::Kind::perspective || camera.kind == Camera::Kind::orthographic,
       "kind", static_cast<float>(camera.kind), "perspective or orthographic");
  const char *finite = "finite and not 0", *positive = "finite, 0 or more";
  if (camera.kind == Camera::Kind::perspective)
    that(camera.fov_y > 0 && camera.fov_y < std::numbers::pi_v<float>, "field of view",
         camera.fov_y, "above 0 and below pi radians");
  else
    that(std::isfinite(camera.half_height) && camera.half_height != 0, "half height",
         camera.half_height, finite);
  that(camera.lens_radius >= 0 && std::isfinite(camera.lens_radius), "lens radius",
       camera.lens_radius, positive);
  that(camera.focus_distance >= 0 && std::isfinite(camera.focus_distance), "focus distance",
       camera.focus_distance, positive);
}

/// Applies --aperture and --focus-distance. Without a focus distance the camera focuses on what it
/// looks at, or on the middle of the scene, which a note tells: it is another in each frame.
void set_lens(const Scene& scene, const RenderOptions& options, Camera& camera,
              std::vector<std::string>& notes) {
  if (options.aperture) camera.lens_radius = *options.aperture;
  if (options.focus_distance) camera.focus_distance = *options.focus_distance;
  if (options.focus_distance && camera.lens_radius == 0)
    throw Error(ErrorKind::usage, "--focus-distance needs --aperture: the camera has no lens");
  if (camera.lens_radius == 0 || camera.focus_distance > 0) return;
  camera.focus_distance =
      view_depth(camera, options.look ? options.look->at : scene_bounds(scene).center());
  if (!(camera.focus_distance > 0))
    throw Error(ErrorKind::usage,
                "--aperture needs --focus-distance: the middle of the scene is behind the camera");
  if (!options.look)
    notes.push_back(fmt::format(
        "the camera focuses on the middle of the scene; other frames are in focus there with "
        "--focus-distance {}",
        camera.focus_distance));
}

}  // namespace

View choose_view(const Scene& scene, const RenderOptions& options,
                 std::vector<std::string>& notes) {
  View view{choose_camera(scene, options, notes), options.width, options.height,
            options.crop.value_or(PixelRect{0, 0, options.width - 1, options.height - 1})};
  if (options.fov_degrees > 0 && view.camera.kind == Camera::Kind::perspective) {
    view.camera.fov_y = radians(options.fov_degrees);
  }
  check_camera(scene, view.camera);
  set_lens(scene, options, view.camera, notes);
  return view;
}

TexelFootprint texel_footprint(const RenderOptions& options, int spp) {
  if (options.estimator == Estimator::exact || options.footprint == 0) return {};
  const float footprint = options.footprint / static_cast<float>(spp);
  TexelFootprint texels;
  if (splitting_factor(options) == 1) {
    texels.share = texels.spread = kTexelShare * footprint;
    return texels;
  }
  texels.share = std::min(kTexelShareOfTap * footprint, kMaxTexelShare);
  const float taps = std::min(kTapShare * footprint, kMaxTapShare);
  texels.tap_offset = 0.25f * std::sqrt(taps);
  texels.spread = kTapVariance * taps + kTexelVariance * texels.share;
  texels.tap_centring = 1.0f - std::sqrt(1.0f - texels.spread);
  return texels;
}

Projection::Projection(const View& view)
    : to_camera_(Imath::M44d(view.camera.to_world).inverse()),
      middle_(view.width / 2.0, view.height / 2.0),
      perspective_(view.camera.kind == Camera::Kind::perspective) {
  const Imath::V2d half(half_extent(view));
  pixels_ = {middle_.x / half.x, -middle_.y / half.y};
}

std::optional<Imath::V2d> Projection::operator()(const V3d& at) const {
  V3d on_plane;
  to_camera_.multDirMatrix(at, on_plane);  // the matrix is affine: no division
  on_plane += to_camera_.translation();
  double scale = 1;
  if (perspective_) {
    if (!(on_plane.z < 0)) return {};
    scale = -1 / on_plane.z;
  }
  return middle_ + Imath::V2d(on_plane.x, on_plane.y) * pixels_ * scale;
}

float pixel_width(const View& view, const V3f& at) {
  const float width = 2 * half_extent(view).y / static_cast<float>(view.height);
  const V3f from = view.camera.to_world.translation();
  return view.camera.kind == Camera::Kind::orthographic ? width : width * (at - from).length();
}

Viewpoint viewpoint(const View& view) {
  const M44f& m = view.camera.to_world;
  const bool perspective = view.camera.kind == Camera::Kind::perspective;
  const V3f at =
      perspective ? V3f(m[3][0], m[3][1], m[3][2]) : V3f(m[2][0], m[2][1], m[2][2]).normalized();
  return {{at.x, at.y, at.z}, perspective ? 1.0f : 0.0f, 1};
}

CameraParams camera_params(const View& view, const RenderOptions& options, const Box3f& bounds) {
  CameraParams params{};
  const M44f& m = view.camera.to_world;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) params.to_world[4 * row + column] = m[column][row];
  }
  const V2f half = half_extent(view);
  params.half_width = half.x;
  params.half_height = half.y;
  params.orthographic = view.camera.kind == Camera::Kind::orthographic ? 1u : 0u;
  params.lens_radius = view.camera.lens_radius;
  params.inverse_focus = view.camera.lens_radius > 0 ? 1.0f / view.camera.focus_distance : 0.0f;
  params.width = static_cast<uint>(view.width);
  params.height = static_cast<uint>(view.height);
  params.crop_x = static_cast<uint>(view.crop.x0);
  params.crop_y = static_cast<uint>(view.crop.y0);
  params.crop_width = static_cast<uint>(view.crop.width());
  params.seed = options.seed;
  params.inverse_spp = 1.0f / static_cast<float>(footprint_samples(options));
  const TexelFootprint texels = texel_footprint(options, footprint_samples(options));
  params.texel_share = texels.share;
  params.tap_offset = texels.tap_offset;
  params.tap_centring = texels.tap_centring;
  params.medium_error = medium_error(options);
  params.splitting_bits = static_cast<uint>(std::countr_zero(splitting_factor(options)));
  set_seen(view, bounds, params);
  return params;
}

M44f world_to_exr_camera(const Camera& camera) {
  M44f flip;
  flip[2][2] = -1.0f;
  return camera.to_world.inverse() * flip;
}

M44f world_to_ndc(const View& view) {
  const V2f half = half_extent(view);
  // Maps the image plane to [0,1], y down. Coordinates are homogeneous, so the offsets of 0.5 are
  // multiplied by w.
  M44f projection;
  projection[0][0] = 0.5f / half.x;
  projection[1][1] = -0.5f / half.y;
  const bool perspective = view.camera.kind == Camera::Kind::perspective;
  const int from = perspective ? 2 : 3;  // w is z, or 1
  projection[from][0] += 0.5f;
  projection[from][1] += 0.5f;
  if (perspective) {
    projection[2][3] = 1.0f;
    projection[3][3] = 0.0f;
  }
  return world_to_exr_camera(view.camera) * projection;
}

}  // namespace dapple
