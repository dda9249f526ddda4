// What the paper experiment compares, and measuring it: the same picture by several
// estimators and ray counts, in turn.
#pragma once

#include <string>
#include <vector>

#include "accuracy/picture_scene.hpp"

namespace dapple::bench {

/// One way to make the picture: AO and light rays of each primary sample.
struct PaperVariant {
  std::string name;
  Estimator estimator;
  int rays;
  float footprint;
};

/// exact with 4, 9 and 25 rays; prefiltered with the footprint of a pixel's share, n = primary
/// samples times rays; and with the paper's, n = rays, which is as many times wider as there
/// are primary samples.
std::vector<PaperVariant> paper_variants(int primary_samples);

/// Of one variant and one pass.
struct PaperFigures {
  double seconds = 0;  ///< occlusion rays alone, median
  double noise = 0;    ///< standard deviation of a pixel from seed to seed
  double rmse = 0;     ///< of one picture against converged exact
};

struct PaperRow {
  PaperVariant variant;
  PaperFigures ao, light;
};

/// Renders each variant `repeats` times, interleaved, each time with another seed, and as
/// many exact pictures of 25 rays of other seeds as a reference, whose own noise is taken
/// out of every RMSE.
std::vector<PaperRow> measure_paper(PictureScene& scene, const RenderOptions& options, int repeats);

}  // namespace dapple::bench
