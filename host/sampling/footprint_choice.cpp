#include "sampling/footprint_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sampling/bias_estimate.hpp"

namespace dapple {
namespace {

/// Rays of a layer, at first and at most. A difference between a prefiltered and an exact ray has a
/// standard deviation of about 0.2.
constexpr std::size_t kFirstRays = 1u << 15, kMostRays = 1u << 20;

/// Smallest part of the scale that is tried before 0.
constexpr float kSmallestPart = 1.0f / 16;

/// Rays of a layer for a target of 1: with them the squared bias is known to a tenth of the squared
/// target. The number grows as the square falls.
constexpr double kRaysOfTarget = 6.5;
constexpr std::size_t kFewestRaysOfTarget = 1u << 12, kMostRaysOfTarget = 1u << 18;

enum class Verdict { small_enough, too_large, unknown };

Verdict judge(const std::vector<Bias>& layers, double most) {
  Verdict verdict = Verdict::small_enough;
  for (const Bias& bias : layers) {
    const double mean = std::fabs(bias.mean);
    if (mean - 2 * bias.error > most) return Verdict::too_large;
    if (mean + 2 * bias.error > most) verdict = Verdict::unknown;
  }
  return verdict;
}

/// Whether the bias is at most `most`; it is not if that cannot be told.
bool is_small(BiasSource& source, float footprint, double most) {
  for (std::size_t rays = kFirstRays;; rays *= 2) {
    source.grow(rays);
    const Verdict verdict = judge(source.bias(footprint), most);
    if (verdict != Verdict::unknown) return verdict == Verdict::small_enough;
    if (rays >= kMostRays || source.is_complete()) return false;
  }
}

/// The bias that counts for a target.
double rmse_of(BiasSource& source, float footprint, double target) {
  source.grow(std::clamp(static_cast<std::size_t>(kRaysOfTarget / (target * target)),
                         kFewestRaysOfTarget, kMostRaysOfTarget));
  double largest = 0;
  for (const Bias& bias : source.bias(footprint)) largest = std::max(largest, mean_square(bias));
  return std::sqrt(largest * source.seen());
}

std::string note_of(const FootprintDemand& demand, float footprint) {
  const std::string why = demand.max_bias > 0 ? fmt::format("--max-bias {}", demand.max_bias)
                                              : std::string("the target");
  return footprint > 0
             ? fmt::format("{}: footprint {}", why, footprint)
             : fmt::format("{}: footprint 0, exact rays: no other has so little bias", why);
}

}  // namespace

FootprintChoice choose_footprint(BiasSource& source, const FootprintDemand& demand) {
  FootprintChoice choice{demand.footprint, 0, {}};
  const double target = double{demand.target};
  for (; choice.footprint > 0; choice.footprint *= 0.5f) {
    if (choice.footprint < kSmallestPart * demand.footprint) choice.footprint = 0;
    if (choice.footprint == 0) break;
    if (demand.may_shrink && demand.max_bias > 0 &&
        !is_small(source, choice.footprint, double{demand.max_bias}))
      continue;
    if (demand.target <= 0) break;
    choice.bias_rmse = rmse_of(source, choice.footprint, target);
    if (!demand.may_shrink || choice.bias_rmse <= 0.5 * target) break;
  }
  if (choice.footprint == 0) choice.bias_rmse = 0;
  if (demand.may_shrink && (demand.max_bias > 0 || choice.footprint != demand.footprint))
    choice.note = note_of(demand, choice.footprint);
  return choice;
}

}  // namespace dapple
