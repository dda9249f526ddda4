// How far above the horizon each point of a picture looks. In: the camera's matrices in a film's
// metadata. Out: the sine of the elevation.
#pragma once

#include "dapple/film.hpp"

namespace dapple {

class PixelElevation {
 public:
  /// `film` may have been made without a camera: the horizon is then its lower edge.
  explicit PixelElevation(const Film& film);

  /// In [-1,1], +1 straight up (+Y); x and y in pixels of the display window, y down.
  [[nodiscard]] float sine(float x, float y) const;

 private:
  M44f camera_to_world_;
  V3f scale_, offset_;  ///< of (x, y, 1): a direction in the camera's space
  bool has_camera_ = false;
  float height_;
};

}  // namespace dapple
