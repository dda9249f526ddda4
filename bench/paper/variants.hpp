// Measurements of the paper experiment. In: a scene and options. Out: seconds and errors of one
// picture with several estimators and numbers of rays.
#pragma once

#include <string>
#include <vector>

#include "accuracy/picture_scene.hpp"

namespace dapple::bench {

/// One way to render the picture. `rays`: AO rays, and rays to each light, of a primary sample.
struct PaperVariant {
  std::string name;
  Estimator estimator;
  int rays;
  float footprint;
};

/// Exact, prefiltered, and prefiltered as in the paper, each with 4, 9 and 25 rays. A footprint is
/// the n-th part of the hemisphere: n = primary samples times rays here, n = rays in the paper,
/// whose footprints therefore have a larger area.
std::vector<PaperVariant> paper_variants(int primary_samples);

/// Results of one variant and one pass.
struct PaperFigures {
  double seconds = 0;  ///< of the occlusion rays only, median
  double noise = 0;    ///< standard deviation of a pixel from seed to seed
  double rmse = 0;     ///< of one picture against converged exact
};

struct PaperRow {
  PaperVariant variant;
  PaperFigures ao, light;
};

/// Renders each variant `repeats` times, interleaved and with different seeds. The reference is the
/// mean of as many exact pictures of 25 rays with other seeds. Its variance is subtracted from
/// every squared error.
std::vector<PaperRow> measure_paper(PictureScene& scene, const RenderOptions& options, int repeats);

}  // namespace dapple::bench
