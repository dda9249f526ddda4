#include "points/local_footprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dapple {
namespace {

/// The standard error of a value, times the root of its number of rays: less than most have.
constexpr double kErrorOfRay = 0.1;

/// The largest RMSE over tiles, and the least that it is within the noise.
struct Local {
  double rmse = 0, least = 0;
};

Local local_bias(const std::vector<Bias>& layers) {
  Local of_all;
  for (const Bias& bias : layers) {
    const double square = bias.tile_rmse * bias.tile_rmse;
    const double limit = bias.tile_rmse_limit * bias.tile_rmse_limit;
    of_all.rmse = std::max(of_all.rmse, bias.tile_rmse);
    of_all.least = std::max(of_all.least, std::sqrt(std::max(0.0, 2 * square - limit)));
  }
  return of_all;
}

}  // namespace

FootprintChoice choose_local_footprint(BiasSource& source, float footprint, int rays) {
  FootprintChoice choice{footprint, 0, {}};
  const double most = kErrorOfRay / std::sqrt(static_cast<double>(rays));
  const Local first = local_bias(source.bias(footprint));
  if (!(first.least > most)) return choice;
  const float smallest = kSmallestPart * footprint;
  do {
    choice.footprint *= 0.5f;
  } while (choice.footprint >= smallest && local_bias(source.bias(choice.footprint)).least > most);
  if (choice.footprint < smallest) choice.footprint = 0;
  choice.note = fmt::format(
      "{} in place of footprint {}, with which single values would be off by about {:.4f} beside "
      "their noise; --max-bias 0 keeps that",
      footprint_text(choice.footprint), footprint, first.rmse);
  return choice;
}

}  // namespace dapple
