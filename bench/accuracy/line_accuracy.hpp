// Part three of the accuracy bench: steps of AO along a line. In: a scene and footprint scales.
// Out: the largest change between neighbouring points, and between frames of a moving camera.
#pragma once

#include <string>
#include <vector>

#include "dapple/options.hpp"

namespace dapple::bench {

struct LineAccuracyOptions {
  std::vector<float> footprints{0.5f, 1, 2, 4};
  int points = 1000;     ///< on the line, from one side of the scene to the other
  int rays_across = 64;  ///< square root of the rays for each point
  int frames = 100;      ///< of the camera that moves away
  int size = 64;         ///< width and height of a frame, pixels
  int seeds = 2;         ///< pictures of each frame
  RenderOptions render;  ///< samples, device, opacities
};

/// The largest changes from one point or frame to the next, at one footprint.
struct LineAccuracyRow {
  std::string what;  ///< which rays, or the camera
  float footprint = 0;
  double exact = 0, prefiltered = 0;  ///< largest change of mean AO
  double excess = 0;  ///< the largest (prefiltered change - exact change) at one step
  double error = 0;   ///< largest standard error of the difference of the two changes
};

std::vector<LineAccuracyRow> measure_line(const std::string& spec,
                                          const LineAccuracyOptions& options);

std::string line_text(const std::vector<LineAccuracyRow>& rows);

}  // namespace dapple::bench
