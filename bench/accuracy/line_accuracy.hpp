// Part three of the accuracy bench: whether occlusion pops when the point, or the camera,
// moves by a little.
#pragma once

#include <string>
#include <vector>

#include "dapple/options.hpp"

namespace dapple::bench {

struct LineAccuracyOptions {
  std::vector<float> footprints{0.5f, 1, 2, 4};
  int points = 1000;     ///< on the line, from side to side of the scene
  int rays_across = 64;  ///< squared: rays a point
  int frames = 100;      ///< of the camera that is pulled back
  int size = 64;         ///< of a frame, both ways, pixels
  int seeds = 2;         ///< pictures of each frame
  RenderOptions render;  ///< samples, device, opacities
};

/// The largest changes from one point or frame to the next, at one footprint.
struct LineAccuracyRow {
  std::string what;  ///< which rays, or the camera
  float footprint = 0;
  double exact = 0, prefiltered = 0;  ///< largest change of mean AO
  double excess = 0;  ///< the most that a prefiltered change is beyond the exact one there
  double error = 0;   ///< largest standard error of the difference of the two changes
};

std::vector<LineAccuracyRow> measure_line(const std::string& spec,
                                          const LineAccuracyOptions& options);

std::string line_text(const std::vector<LineAccuracyRow>& rows);

}  // namespace dapple::bench
