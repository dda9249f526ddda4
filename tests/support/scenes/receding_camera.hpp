// A camera that moves away from a tree's crown, frame by frame, and the mean AO of the surfaces
// seen inside the same ball in each frame. Pixels grow with the distance, and footprints with the
// pixels. In: a scene and an estimator; out: AO of each frame, and its change from frame to frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dapple/render.hpp"
#include "render/picture.hpp"
#include "support/scenes/line_of_points.hpp"

namespace dapple::popping {

/// Distances grow by a constant factor a frame, from kNearest radii of the ball to `times` as far.
class RecedingCamera {
 public:
  RecedingCamera(const Box3f& box, int frame_count, float times)
      : centre_(box.min + box.size() * V3f(0.5f, 0.65f, 0.5f)),
        radius_(0.2f * box.size().length()),
        times_(times),
        frame_count_(frame_count) {}

  [[nodiscard]] int frame_count() const { return frame_count_; }
  [[nodiscard]] Camera camera(int frame) const {
    const V3f towards = V3f(0.8f, 0.25f, 0.55f).normalized();
    return look_at(centre_ + towards * distance(frame), centre_, {0, 1, 0}, kFov);
  }
  /// Radius of the ball's outline in the picture, in units of half the picture's height.
  [[nodiscard]] float outline(int frame) const {
    return std::tan(std::asin(radius_ / distance(frame))) / std::tan(0.5f * kFov);
  }

 private:
  static constexpr float kFov = 0.7f;
  static constexpr float kNearest = 3;  ///< in radii of the ball
  [[nodiscard]] float distance(int frame) const {
    const float share = static_cast<float>(frame) / static_cast<float>(frame_count_ - 1);
    return radius_ * kNearest * std::pow(times_, share);
  }

  V3f centre_;
  float radius_, times_;
  int frame_count_;
};

/// Values of a frame, each pixel weighted by its share inside the ball's outline.
struct Frame {
  double hits = 0;         ///< number of samples that hit something, over all pixels and seeds
  std::vector<double> ao;  ///< sum of AO, one entry per pixel and seed
};

/// Share of a square pixel that lies inside a circle around the picture's middle.
inline double share_inside(int column, int row, int size, float radius) {
  constexpr int kAcross = 8;
  const auto coordinate = [size](int pixel, int part) {
    return 2 * (pixel + (part + 0.5) / kAcross) / size - 1;
  };
  int inside = 0;
  for (int j = 0; j < kAcross; ++j) {
    for (int i = 0; i < kAcross; ++i)
      inside += std::hypot(coordinate(column, i), coordinate(row, j)) < radius;
  }
  return inside / static_cast<double>(kAcross * kAcross);
}

/// Renders square frames of AO, several seeds each. The scene must outlive this object.
class FrameTracer {
 public:
  FrameTracer(const Device& device, const DeviceScene& scene, const Box3f& bounds,
              const RenderOptions& options, int size, int seeds)
      : device_(device), scene_(scene), bounds_(bounds), options_(options), seeds_(seeds) {
    options_.width = options_.height = size;
    options_.light = options_.albedo = false;
  }

  [[nodiscard]] std::vector<Frame> frames(const RecedingCamera& path, Estimator estimator,
                                          float footprint) const {
    std::vector<Frame> frames(static_cast<std::size_t>(path.frame_count()));
    for (int f = 0; f < path.frame_count(); ++f) {
      for (int seed = 0; seed < seeds_; ++seed)
        add(path.camera(f), path.outline(f), estimator, footprint, seed,
            frames[static_cast<std::size_t>(f)]);
    }
    return frames;
  }

 private:
  void add(const Camera& camera, float outline, Estimator estimator, float footprint, int seed,
           Frame& frame) const {
    RenderOptions options = options_;
    options.estimator = estimator;
    options.footprint = footprint;
    options.seed = static_cast<std::uint32_t>(seed);
    const View view{camera, options.width, options.width, around(outline, options.width)};
    const FilmLayout layout(view.crop, options, film_scales(view, bounds_, {}), {});
    const TracedPicture picture = trace_picture(device_, scene_, view, options, layout, {});
    std::size_t pixel = 0;
    for (int row = view.crop.y0; row <= view.crop.y1; ++row) {
      for (int column = view.crop.x0; column <= view.crop.x1; ++column, ++pixel) {
        const double share = share_inside(column, row, options.width, outline);
        if (share <= 0) continue;
        const auto plane = [&](std::size_t p) {
          return static_cast<double>(
              picture.sums.values<std::int64_t>()[p * layout.pixels + pixel]);
        };
        // Planes are in the order of kernels/film/film.cl: the first counts the samples that hit.
        frame.hits += share * plane(0);
        frame.ao.push_back(share * plane(layout.ao) /
                           (double{layout.unit_scale} * options.ao_rays));
      }
    }
  }

  /// The pixels that a circle around the picture's middle touches.
  static PixelRect around(float radius, int size) {
    const int margin =
        std::max(0, static_cast<int>(0.5f * (1 - radius) * static_cast<float>(size)));
    return {margin, margin, size - 1 - margin, size - 1 - margin};
  }

  const Device& device_;
  const DeviceScene& scene_;
  Box3f bounds_;
  RenderOptions options_;
  int seeds_;
};

/// Change of the mean AO from a frame to the next, exact and prefiltered (both with the same camera
/// rays), and the standard error of the difference of the two changes.
inline Step frame_step(const Frame& exact, const Frame& exact_next, const Frame& prefiltered,
                       const Frame& prefiltered_next) {
  const auto mean = [](const Frame& frame) {
    double sum = 0;
    for (const double ao : frame.ao) sum += ao;
    return sum / frame.hits;
  };
  // Pixels and seeds are independent. Frames use the same directions from other positions.
  const auto variance = [](const Frame& a, const Frame& b) {
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < a.ao.size(); ++i) {
      const double d = a.ao[i] - b.ao[i];
      sum += d;
      squares += d * d;
    }
    const double mean_square = sum * sum / static_cast<double>(a.ao.size());
    return std::max(0.0, squares - mean_square) / (a.hits * a.hits);
  };
  return {mean(exact_next) - mean(exact), mean(prefiltered_next) - mean(prefiltered),
          std::sqrt(variance(exact, prefiltered) + variance(exact_next, prefiltered_next))};
}

inline std::vector<Step> steps(const std::vector<Frame>& exact,
                               const std::vector<Frame>& prefiltered) {
  std::vector<Step> found;
  for (std::size_t f = 0; f + 1 < exact.size(); ++f)
    found.push_back(frame_step(exact[f], exact[f + 1], prefiltered[f], prefiltered[f + 1]));
  return found;
}

}  // namespace dapple::popping
