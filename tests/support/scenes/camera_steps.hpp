// What pictures change by while a camera moves in small steps. In: a scene with a camera, options
// of square pictures; out: means of the 16 blocks of each frame, and how much they change.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dapple/render.hpp"

namespace dapple::camera_steps {

inline constexpr std::size_t kBlocks = 4;  ///< in each direction

struct Frame {
  std::vector<double> blocks;  ///< means of a layer's first channel
  float footprint = 0;         ///< that the frame was rendered with; 0: exact
};

inline std::vector<double> block_means(const Film& film, const std::string& layer) {
  const std::vector<float>& pixels = film.find(layer + ".R")->pixels;
  const auto size = static_cast<std::size_t>(film.width), block = size / kBlocks;
  std::vector<double> means(kBlocks * kBlocks);
  for (std::size_t p = 0; p < pixels.size(); ++p)
    means[p / size / block * kBlocks + p % size / block] +=
        double{pixels[p]} / static_cast<double>(block * block);
  return means;
}

/// `count` frames, between which the camera moves by `step_m` metres along x and z.
inline std::vector<Frame> frames(Scene scene, float step_m, const std::string& layer,
                                 const RenderOptions& options, int count) {
  Renderer renderer;  // keeps the BVH
  std::vector<Frame> found;
  for (int i = 0; i < count; ++i) {
    const RenderResult result = renderer.render(scene, options);
    const bool is_exact = options.estimator == Estimator::exact;
    found.push_back(
        {block_means(result.film, layer), is_exact ? 0.0f : result.statistics.footprint});
    for (const int axis : {0, 2}) scene.cameras[0].to_world[3][axis] += step_m;
  }
  return found;
}

/// The largest change of a block's mean from one frame to the next.
inline double largest_step(const std::vector<Frame>& sequence) {
  double largest = 0;
  for (std::size_t i = 1; i < sequence.size(); ++i)
    for (std::size_t b = 0; b < sequence[i].blocks.size(); ++b)
      largest = std::max(largest, std::fabs(sequence[i].blocks[b] - sequence[i - 1].blocks[b]));
  return largest;
}

/// By how much the step of a block into frame `i` is larger than the exact one, at most.
inline double excess(const std::vector<Frame>& sequence, const std::vector<Frame>& exact,
                     std::size_t i) {
  double most = -1;
  for (std::size_t b = 0; b < exact[i].blocks.size(); ++b) {
    const auto step = [&](const std::vector<Frame>& of) {
      return std::fabs(of[i].blocks[b] - of[i - 1].blocks[b]);
    };
    most = std::max(most, step(sequence) - step(exact));
  }
  return most;
}

}  // namespace dapple::camera_steps
