#include "rivals/embree/camera_rays.hpp"

#include <cmath>
#include <limits>

#include "rivals/embree/stratified.hpp"

namespace dapple::bench {
namespace {

V3f row(const M44f& m, int i) { return {m[i][0], m[i][1], m[i][2]}; }

}  // namespace

CameraRays::CameraRays(const View& view)
    : eye_(row(view.camera.to_world, 3)),
      right_(row(view.camera.to_world, 0)),
      up_(row(view.camera.to_world, 1)),
      forward_(-row(view.camera.to_world, 2)),
      orthographic_(view.camera.kind == Camera::Kind::orthographic),
      width_(view.width),
      height_(view.height) {
  half_height_ = orthographic_ ? view.camera.half_height : std::tan(0.5f * view.camera.fov_y);
  half_width_ = half_height_ * static_cast<float>(width_) / static_cast<float>(height_);
}

void CameraRays::fill(const std::uint32_t* pixel, const std::uint32_t* sample, unsigned count,
                      std::uint32_t seed, float* x, float* y, RayBatch& rays) const {
  sample_squares(pixel, sample, count, kPixelPair, seed, x, y);
  ray_keys(pixel, sample, count, kPixelPair, seed, rays.key);
  const auto columns = static_cast<std::uint32_t>(width_);
  const float across = 2.0f * half_width_ / static_cast<float>(width_);
  const float down = 2.0f * half_height_ / static_cast<float>(height_);
  for (unsigned i = 0; i < count; ++i) {
    const std::uint32_t line = pixel[i] / columns;
    const auto column = static_cast<float>(pixel[i] - line * columns);
    const V3f aside = right_ * ((column + x[i]) * across - half_width_) +
                      up_ * (half_height_ - (static_cast<float>(line) + y[i]) * down);
    const V3f origin = orthographic_ ? eye_ + aside : eye_;
    const V3f direction = orthographic_ ? forward_ : forward_ + aside;
    const V3f unit = direction * (1.0f / std::sqrt(direction.dot(direction)));
    for (int axis = 0; axis < 3; ++axis) {
      rays.origin[axis][i] = origin[axis];
      rays.direction[axis][i] = unit[axis];
    }
    rays.t_max[i] = std::numeric_limits<float>::infinity();
  }
  rays.count = count;
}

}  // namespace dapple::bench
