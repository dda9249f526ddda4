// How much of the sky and of lights reaches points among leaves. In: a scene, points with normals,
// options. Out: named columns of numbers with standard errors. First order only: nothing scatters.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dapple/options.hpp"
#include "dapple/render.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// Direct light that is the same everywhere, from a disk as wide as the sun's, 0.533 degrees.
struct SunDirection {
  V3f direction{0, 1, 0};  ///< unit, towards its middle
  float irradiance = 1;    ///< W/m^2 on a plane across it
};

struct PointOptions {
  bool ao = true;  ///< ambient occlusion about the normal
  /// The same about +Y, whatever the normal, without `distance` and `falloff`.
  bool sky_view_factor = true;
  bool bent = false;  ///< mean unoccluded direction
  /// Zenith rings whose gap fraction is measured, [0, 90]; 5: those of the LAI-2200 (0-13, 16-28,
  /// 32-43, 47-58 and 61-74 degrees), others: of equal width from 0 to 90 degrees.
  int rings = 0;
  bool lights = true;  ///< irradiance of each of the scene's lights
  std::vector<SunDirection> suns = {};
  /// A column for each sun, of one ray to a random place of its disk; else one for the sum.
  bool per_sun = false;
  /// For each point and quantity, in eight sets, [8, 2^20]; of all suns together. If there are more
  /// suns than rays, each ray stands for some of them.
  int rays = 256;
  Estimator estimator = Estimator::prefiltered;
  float footprint = 1.0f;                  ///< of the rays of one set, [0, 1e6]
  float report_bias = kDefaultReportBias;  ///< 0: PointResult::bias stays empty
  /// The footprint is the largest of `footprint`, a half of it, a quarter and so on with which the
  /// bias, before it is corrected, is at most this, [0,1]; 0: `footprint`. None: with which the
  /// correction leaves less in single values than their standard errors, if it clearly leaves more.
  std::optional<float> max_bias = {};
  float distance = 0;  ///< of AO, as RenderOptions::ao_distance
  float falloff = 0;   ///< of AO, as RenderOptions::ao_falloff
  /// The scene repeats itself with these periods along X and Z, metres; 0: it does not. Its lights
  /// do not.
  float period_x = 0, period_z = 0;
  std::uint32_t seed = 0;
  std::vector<std::pair<std::string, float>> opacity = {};  ///< of materials by name, [0,1]
  bool ground = false;  ///< an opaque plane under the scene occludes
  std::string device = {}, kernel_dir = {}, cache = {};  ///< as in RenderOptions
};

/// Throws Error usage, naming the command line's flag, when a value is out of range.
void validate(const PointOptions& options);

/// One value for each point.
struct PointColumn {
  std::string name;  ///< such as "ao" and "ao_error", its standard error
  std::vector<float> values;
};

struct PointResult {
  /// ao, sky_view_factor and gap_N in [0,1]; bent_x, bent_y and bent_z a unit vector or zero;
  /// NAME_r, NAME_g and NAME_b of a light, and sun or sun_N, in W/m^2. With each an _error, its
  /// standard error; bent_ and sun_N have none.
  std::vector<PointColumn> columns;
  /// The bias before it was corrected, by quantity: "ao", "sky_view_factor", "gap_N", "light.NAME",
  /// and "sun", the sum of all; lights and suns are relative to the unoccluded
  /// irradiance. The RMSE over tiles (of neighbouring points) is what the correction leaves.
  std::map<std::string, Bias> bias;
  float footprint = 0;  ///< PointOptions::footprint, or what was chosen (max_bias)
  std::vector<std::string> notes;
  /// Seconds of BVHs; of the rest before rays are traced: of the device, its kernels and the
  /// upload; and of tracing.
  double build_seconds = 0, prepare_seconds = 0, trace_seconds = 0;
  std::string device;
  bool interrupted = false;  ///< stopped: quantities that were not finished have no columns
};

/// Measures at `points`, whose unit `normals` say where the surface faces. Rays start off the
/// points along the normals by more than rounding errors. The same arguments give the same bits.
/// Uses only progress and stop of `control`.
/// Throws Error usage (also if sizes differ, a number is not finite, the length of a normal or of
/// a sun's direction is not 1 within 0.001, or an irradiance is negative), input, device or failed.
PointResult measure_points(Scene scene, std::span<const V3f> points, std::span<const V3f> normals,
                           const PointOptions& options = {}, const RenderControl& control = {});

}  // namespace dapple
