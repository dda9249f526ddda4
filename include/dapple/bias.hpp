// The bias of prefiltered values, as a run measures it: a part of its rays is traced exactly, too.
#pragma once

namespace dapple {

/// Prefiltered minus exact. Of AO absolute, of lights relative to their largest unoccluded
/// irradiance.
struct Bias {
  double mean = 0;   ///< over pixels that show geometry, values, or points
  double error = 0;  ///< standard error of `mean`
  /// Root mean square of the bias of tiles (of pixels, or of neighbouring values), without noise.
  double tile_rmse = 0;
  /// What tile_rmse is below with some certainty: two standard errors of its square are added.
  double tile_rmse_limit = 0;
  double share = 0;  ///< of the rays that were traced exactly, [0,1]
};

/// Share of the rays that are traced exactly by default.
inline constexpr float kDefaultReportBias = 0.02f;

}  // namespace dapple
