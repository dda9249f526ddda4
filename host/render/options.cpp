// Checks RenderOptions of dapple/options.hpp. In: options. Out: nothing, or an Error that names the
// option and its range. Also the names of their values, and how many samples footprints are
// computed for.
#include "dapple/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "dapple/error.hpp"
#include "render/option_check.hpp"
#include "scene/check/numeric_range.hpp"

namespace dapple {
namespace {

void check_point(const char* flag, const V3f& v) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(double{v[axis]}) <= kLargestCoordinate) continue;  // false for NaN
    throw Error(ErrorKind::usage,
                fmt::format("{} has the coordinate {:g}; it must be from {:g} to {:g}", flag,
                            v[axis], -kLargestCoordinate, kLargestCoordinate));
  }
}

void check_crop(const RenderOptions& options) {
  if (!options.crop) return;
  const PixelRect& c = *options.crop;
  if (c.x0 >= 0 && c.y0 >= 0 && c.x0 <= c.x1 && c.y0 <= c.y1 && c.x1 < options.width &&
      c.y1 < options.height)
    return;
  if (c.x0 > c.x1 || c.y0 > c.y1)
    throw Error(ErrorKind::usage,
                fmt::format("--crop {},{},{},{} has no pixels: X0,Y0,X1,Y1 begins at the upper "
                            "left, both ends are included",
                            c.x0, c.y0, c.x1, c.y1));
  throw Error(
      ErrorKind::usage,
      fmt::format(
          "--crop {},{},{},{} is not inside the {}x{} picture (X0,Y0,X1,Y1, both ends included)",
          c.x0, c.y0, c.x1, c.y1, options.width, options.height));
}

/// `rays`: of one kind, for each camera sample.
void check_sample_product(const char* flag, const RenderOptions& options, int rays) {
  const bool adaptive = is_adaptive(options);
  const int spp = adaptive ? options.max_spp : options.spp;
  if (static_cast<double>(spp) * rays <= kMaxRaysOfPixel) return;
  throw Error(ErrorKind::usage,
              fmt::format("{} {} times {} {} is more than {} rays a pixel",
                          adaptive ? "--max-spp" : "--spp", spp, flag, rays, kMaxRaysOfPixel));
}

void check_camera_splitting(int factor) {
  if (factor == 0 || factor == 1 || factor == 2 || factor == 4) return;
  throw Error(
      ErrorKind::usage,
      fmt::format("--camera-splitting is {}; it must be 1, 2 or 4, or 0 for what suits the scene",
                  factor));
}

void check_targets(const RenderOptions& options) {
  check_range("--target-error", options.target_error, 0, 1);
  check_range("--target-rmse", options.target_rmse, 0, 1);
  check_range("--max-spp", options.max_spp, 1, 1 << 20);
  if (options.target_error > 0 && options.target_rmse > 0) {
    throw Error(ErrorKind::usage,
                "--target-error and --target-rmse exclude each other: pixels are sampled until "
                "each is below an error, or until all together are");
  }
  if (is_adaptive(options) && options.max_spp < options.spp) {
    throw Error(ErrorKind::usage,
                fmt::format("--max-spp {} is less than --spp {}", options.max_spp, options.spp));
  }
}

void check_shard(const RenderOptions& options) {
  const Shard& shard = options.shard;
  if (shard.count < 1 || shard.index < 1 || shard.index > shard.count) {
    throw Error(ErrorKind::usage,
                fmt::format("--shard {}/{}: expected I/N with I from 1 to N, as in 2/8",
                            shard.index, shard.count));
  }
  if (shard.count == 1) return;
  if (is_adaptive(options)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("--shard does not go with {}: how many samples a pixel needs is decided "
                    "from the samples of all shards; give --spp",
                    options.target_rmse > 0 ? "--target-rmse" : "--target-error"));
  }
  if (shard.count <= options.spp) return;
  throw Error(ErrorKind::usage, fmt::format("--shard {}/{}: --spp {} makes at most {} shards",
                                            shard.index, shard.count, options.spp, options.spp));
}

}  // namespace

std::string name_of(Estimator estimator) {
  switch (estimator) {
    case Estimator::exact:
      return "exact";
    case Estimator::prefiltered:
      return "prefiltered";
  }
  return "";
}

std::string name_of(Normals normals) {
  return normals == Normals::shading ? "shading" : "geometric";
}

std::string name_of(const Cryptomattes& mattes) {
  if (mattes.objects && mattes.materials) return "object,material";
  return mattes.objects ? "object" : mattes.materials ? "material" : "none";
}

std::string name_of(Packets packets) {
  switch (packets) {
    case Packets::automatic:
      return "auto";
    case Packets::none:
      return "none";
    case Packets::pixel:
      return "pixel";
    case Packets::point:
      return "point";
    case Packets::scalar:
      return "scalar";
  }
  return "";
}

namespace {

/// footprint_rmse() of one sample. With sixteen samples the RMSE of the bias, over pixels with a
/// hit, is 0.004 to 0.010 (docs/accuracy.md); it falls with the square root of the number of
/// samples. Sky has no bias (experiment 501).
constexpr double kFootprintRmse = 0.057;

/// The same for the error of single pixels.
constexpr double kFootprintError = 0.08;

}  // namespace

int footprint_samples(const RenderOptions& options) {
  if (options.footprint_spp > 0) return options.footprint_spp;
  if (!is_adaptive(options)) return options.spp;
  const double share = options.target_error > 0 ? kFootprintError / options.target_error
                                                : kFootprintRmse / options.target_rmse;
  const double samples = std::round(share * share);
  return std::max(options.spp, static_cast<int>(std::min<double>(samples, options.max_spp)));
}

float footprint_rmse(const RenderOptions& options) {
  return static_cast<float>(kFootprintRmse / std::sqrt(footprint_samples(options)));
}

void validate(const RenderOptions& options) {
  check_range("--width", options.width, 1, 65535);
  check_range("--height", options.height, 1, 65535);
  check_range("--spp", options.spp, 1, 1 << 20);
  check_enumerator("--estimator", options.estimator, Estimator::prefiltered);
  check_enumerator("--normals", options.normals, Normals::geometric);
  check_enumerator("--packets", options.packets, Packets::scalar);
  check_range("footprint_spp", options.footprint_spp, 0, 1 << 20);
  check_range("footprint_ao_rays", options.footprint_ao_rays, 0, 4096);
  check_targets(options);
  check_shard(options);
  check_camera_splitting(options.camera_splitting);
  check_range("--ao-rays", options.ao_rays, 1, 4096);
  check_range("--light-rays", options.light_rays, 1, 4096);
  check_range("--back-every", options.back_every, 1, 64);
  if (!std::has_single_bit(static_cast<unsigned>(options.back_every)))
    throw Error(
        ErrorKind::usage,
        fmt::format("--back-every is {}; it must be 1, 2, 4, 8, 16, 32 or 64", options.back_every));
  check_range("--footprint", options.footprint, 0, 1e6);
  if (!(options.roulette >= 0 && options.roulette < 1))
    throw Error(ErrorKind::usage, fmt::format("--roulette is {}; it must be at least 0 and below 1",
                                              options.roulette));
  check_range("--report-bias", options.report_bias, 0, 1);
  check_range("--max-bias", options.max_bias.value_or(0), 0, 1);
  check_range("--ao-distance", options.ao_distance, 0, 1e30f);
  check_range("--ao-falloff", options.ao_falloff, 0, 100);
  if (options.ambient) check_range("--ambient", *options.ambient, 0, 1e30f);
  if (options.ao_falloff > 0 && options.ao_distance <= 0) {
    throw Error(ErrorKind::usage, "--ao-falloff needs --ao-distance");
  }
  if (options.fov_degrees != 0) check_range("--fov", options.fov_degrees, 0.01f, 179);
  if (options.aperture) check_range("--aperture", *options.aperture, 0, 1e6);
  if (options.focus_distance)
    check_range("--focus-distance", *options.focus_distance, 1e-6f, kLargestCoordinate);
  if (options.ground_height) {
    check_range("--ground-height", *options.ground_height, -kLargestCoordinate, kLargestCoordinate);
    if (!options.ground) throw Error(ErrorKind::usage, "--ground-height needs --ground");
  }
  if (options.look) {
    check_point("--look-from", options.look->from);
    check_point("--look-at", options.look->at);
    check_point("--up", options.look->up);
  }
  check_crop(options);
  const int splitting = std::max(1, options.camera_splitting);
  check_sample_product("--ao-rays", options, std::max(options.ao_rays, splitting));
  check_sample_product("--light-rays", options, options.light_rays * splitting);
}

}  // namespace dapple
