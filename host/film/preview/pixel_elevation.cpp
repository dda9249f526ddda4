#include "film/preview/pixel_elevation.hpp"

#include <cmath>

namespace dapple {

PixelElevation::PixelElevation(const Film& film) : height_(static_cast<float>(film.height)) {
  const M44f& to_camera = film.metadata.world_to_camera;
  if (!(std::fabs(to_camera.determinant()) > 0)) return;
  camera_to_world_ = to_camera.inverse();
  const M44f to_ndc = camera_to_world_ * film.metadata.world_to_ndc;  // from the camera's space
  const V3f size(static_cast<float>(film.width), height_, 1);
  has_camera_ = to_ndc[0][0] > 0 && to_ndc[1][1] < 0;
  if (!has_camera_) return;
  // A perspective camera has w = z, so at z = 1 the picture's x is x * to_ndc[0][0] + to_ndc[2][0];
  // this is the inverse. A parallel camera looks along z everywhere.
  const bool perspective = to_ndc[2][3] > 0;
  for (int k = 0; k < 2; ++k) {
    scale_[k] = perspective ? 1 / (size[k] * to_ndc[k][k]) : 0.0f;
    offset_[k] = perspective ? -to_ndc[2][k] / to_ndc[k][k] : 0.0f;
  }
}

float PixelElevation::sine(float x, float y) const {
  if (!has_camera_) return 1 - y / height_;
  const V3f in_camera(x * scale_.x + offset_.x, y * scale_.y + offset_.y, 1);
  V3f in_world;
  camera_to_world_.multDirMatrix(in_camera, in_world);
  return in_world.normalized().y;
}

}  // namespace dapple
