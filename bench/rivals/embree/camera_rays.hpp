// Camera rays for Embree. In: the view that dapple renders, and samples of pixels. Out: a batch of
// rays.
#pragma once

#include "camera/view.hpp"
#include "rivals/embree/ray_batch.hpp"

namespace dapple::bench {

class CameraRays {
 public:
  explicit CameraRays(const View& view);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Fills the batch with `count` rays through stratified positions in pixels (row * width +
  /// column). `x` and `y` are scratch memory.
  void fill(const std::uint32_t* pixel, const std::uint32_t* sample, unsigned count,
            std::uint32_t seed, float* x, float* y, RayBatch& rays) const;

 private:
  V3f eye_, right_, up_, forward_;
  float half_width_ = 0, half_height_ = 0;  ///< of the image plane: at distance 1, or in metres
  bool orthographic_ = false;
  int width_ = 0, height_ = 0;  ///< pixels
};

}  // namespace dapple::bench
