#include "commands/arguments/shared_options.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "commands/arguments/argument_errors.hpp"
#include "dapple/error.hpp"

namespace dapple {

CLI::Option* add_prefiltering_options(CLI::App& app, std::string& estimator, float& footprint,
                                      std::string& report_bias) {
  app.add_option("--estimator", estimator,
                 "exact: composite every surface on a ray; prefiltered: stop at BVH nodes that the "
                 "ray's footprint covers")
      ->capture_default_str();
  CLI::Option* scale =
      app.add_option(
             "--footprint", footprint,
             "Scale of ray footprints, the areas that rays represent: larger is faster and less "
             "noisy, smaller is usually closer to exact, 0 is exact")
          ->check(of_values("0..1000000"))
          ->capture_default_str();
  app.add_option("--report-bias", report_bias,
                 "Part of the prefiltered rays to trace exactly, too, to report the bias: a "
                 "percentage, as 2%, or a share below 1, as 0.02; fewer where exact rays are slow; "
                 "0: no report")
      ->capture_default_str();
  return scale;
}

void add_max_bias_option(CLI::App& app, float& max_bias) {
  app.add_option("--max-bias", max_bias,
                 "Choose the largest footprint, from --footprint down to 0, whose bias is below "
                 "this in AO and in each light; 0: take --footprint")
      ->check(of_values("0..1"))
      ->capture_default_str();
}

void add_opacity_option(CLI::App& app, std::vector<std::string>& opacity) {
  app.add_option("--opacity", opacity,
                 "MATERIAL=VALUE: gives a material this opacity, 0 to 1; may be repeated")
      ->allow_extra_args(false);  // SCENE may be the next word
}

void add_ao_range_options(CLI::App& app, float& distance, float& falloff) {
  app.add_option("--ao-distance", distance,
                 "Surfaces farther than this, in metres, don't occlude; 0: no limit")
      ->check(of_values("0..1e+30"))
      ->capture_default_str();
  app.add_option("--ao-falloff", falloff,
                 "Exponent p: a surface at distance t has weight (1 - t/D)^p, D = --ao-distance; "
                 "0: cutoff at D")
      ->check(of_values("0..100"))
      ->capture_default_str();
}

void add_rotation_option(CLI::App& app, const std::string& flag, const char* what,
                         double& degrees) {
  app.add_option(flag, degrees,
                 fmt::format("Rotation of the {} about +Y, degrees, from +Z towards +X", what))
      ->capture_default_str();
}

float dome_rotation(const std::string& flag, double degrees) {
  if (!std::isfinite(degrees))
    throw Error(ErrorKind::usage, flag + " must be a finite number of degrees");
  return static_cast<float>(std::remainder(degrees, 360.0) * std::numbers::pi / 180);
}

void add_light_radius_option(CLI::App& app, float& radius) {
  app.add_option("--light-radius", radius, "Radius that glTF point lights get, metres")
      ->capture_default_str();
}

void add_outside_option(CLI::App& app, bool& allow_outside) {
  app.add_flag("--allow-outside", allow_outside,
               "Let a glTF file refer to buffers and images outside its folder");
}

void add_device_options(CLI::App& app, std::string& device, std::string& kernel_dir,
                        std::string& cache) {
  app.add_option("--device", device, "OpenCL device, by part of its name (see dapple devices)");
  app.add_option("--kernel-dir", kernel_dir,
                 "Read OpenCL kernels from this folder (for developers)");
  app.add_option("--cache", cache,
                 "Keep built BVHs in this folder and reuse them. dapple makes the folder if it is "
                 "missing; you may delete it at any time");
}

void add_report_options(CLI::App& app, std::string& stats_json, bool& quiet) {
  app.add_option("--stats-json", stats_json, "Write the statistics as JSON");
  app.add_flag("-q,--quiet", quiet, "Print only errors");
}

}  // namespace dapple
