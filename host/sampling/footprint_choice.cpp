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

/// Part of a squared target to which the squared bias must be known.
constexpr double kKnownPart = 0.1;

/// The largest part of a target that a bias may be: noise_target() leaves half of it for the noise.
constexpr double kMostOfTarget = 0.8660254;

/// Rays of a layer that are enough for that with a target of 1, whatever the bias. The number grows
/// as the square falls. If the bias is small a fourth of them may do: experiment 545.
constexpr double kRaysOfTarget = 6.5;
constexpr std::size_t kFirstPart = 4;
constexpr std::size_t kFewestRaysOfTarget = 1u << 12, kMostRaysOfTarget = 1u << 18;

/// If only what is clear counts: rays of a layer, at first and at most, and the standard errors by
/// which a bias must be above the limit (experiment 556).
constexpr std::size_t kFirstIfClear = 1u << 15, kMostIfClear = 1u << 16;
constexpr double kClear = 2;
/// The part of the limit that a smaller footprint shall reach, if the first is not kept.
constexpr double kGoalPart = 0.5;

/// What is known of a footprint's bias, of the layer in which it may be largest.
struct Judgement {
  double least = 0, most = 0;  ///< |mean| two standard errors down and up
  bool has_layers = false;
};

Judgement judge(const std::vector<Bias>& layers) {
  Judgement of_all;
  of_all.has_layers = !layers.empty();
  for (const Bias& bias : layers) {
    const double mean = std::fabs(bias.mean);
    of_all.least = std::max(of_all.least, mean - 2 * bias.error);
    of_all.most = std::max(of_all.most, mean + 2 * bias.error);
  }
  return of_all;
}

/// Takes rays until it is clear whether the bias is at most `most`, or there are no more.
Judgement judge(BiasSource& source, float footprint, double most) {
  for (std::size_t rays = kFirstRays;; rays *= 2) {
    source.grow(rays);
    const Judgement found = judge(source.bias(footprint));
    if (found.most <= most || found.least > most) return found;
    if (rays >= kMostRays || source.is_complete()) return found;
  }
}

/// The bias of the layer that has most.
Bias largest_of(const std::vector<Bias>& layers) {
  Bias largest;
  for (const Bias& bias : layers)
    if (std::fabs(bias.mean) > std::fabs(largest.mean)) largest = bias;
  return largest;
}

/// Whether the bias of a layer is clearly above `most`. Takes rays until that is known, or there
/// are enough.
bool is_clearly_above(BiasSource& source, float footprint, double most) {
  for (std::size_t rays = kFirstIfClear;; rays *= 2) {
    source.grow(rays);
    const std::vector<Bias> layers = source.bias(footprint);
    if (std::fabs(largest_of(layers).mean) <= most) return false;
    if (std::any_of(layers.begin(), layers.end(), [&](const Bias& bias) {
          return std::fabs(bias.mean) - kClear * bias.error > most;
        }))
      return true;
    if (rays >= kMostIfClear || source.is_complete()) return false;
  }
}

FootprintChoice choose_if_clear(BiasSource& source, const FootprintDemand& demand) {
  FootprintChoice choice{demand.footprint, 0, {}};
  const double most = double{demand.max_bias}, goal = kGoalPart * most;
  if (!is_clearly_above(source, choice.footprint, most)) return choice;
  const double of_demand = largest_of(source.bias(choice.footprint)).mean;
  const float smallest = kSmallestPart * demand.footprint;
  do {
    choice.footprint *= 0.5f;
  } while (choice.footprint > smallest &&
           std::fabs(largest_of(source.bias(choice.footprint)).mean) > goal);
  if (choice.footprint <= smallest && is_clearly_above(source, smallest, goal))
    choice.footprint = 0;
  choice.note = fmt::format(
      "{} in place of footprint {}, whose bias is about {:+.4f}; --max-bias 0 keeps that",
      footprint_text(choice.footprint), demand.footprint, of_demand);
  return choice;
}

/// The bias that counts for a target. Takes rays until its square is known, or there are enough.
double rmse_of(BiasSource& source, float footprint, double target) {
  const double square = target * target;
  const std::size_t most = std::clamp(static_cast<std::size_t>(kRaysOfTarget / square),
                                      kFewestRaysOfTarget, kMostRaysOfTarget);
  for (std::size_t rays = std::max(kFewestRaysOfTarget, most / kFirstPart);; rays *= 2) {
    source.grow(std::min(rays, most));
    double largest = 0, error = 0;
    for (const Bias& bias : source.bias(footprint)) {
      largest = std::max(largest, mean_square(bias));
      error = std::max(error, error_of_mean_square(bias));
    }
    if (rays >= most || error * source.seen() <= kKnownPart * square)
      return std::sqrt(largest * source.seen());
  }
}

/// `last`: of the smallest footprint that was tried, above 0.
std::string note_of(const FootprintDemand& demand, float footprint, const Judgement& last) {
  if (!(demand.max_bias > 0))
    return fmt::format("for the target, {} in place of footprint {}", footprint_text(footprint),
                       demand.footprint) +
           (footprint > 0 ? ", whose bias is too large" : ": even the smallest has too much bias");
  const std::string why = fmt::format("--max-bias {}: ", demand.max_bias);
  const float smallest = demand.footprint * kSmallestPart;
  if (!last.has_layers)
    return fmt::format("{}footprint {}: nothing is seen whose bias could be measured", why,
                       footprint);
  if (footprint > 0)
    return fmt::format("{}footprint {}, whose bias is at most {:.4f}", why, footprint, last.most);
  if (last.least > double{demand.max_bias})
    return fmt::format("{}exact rays (footprint 0): the bias of footprint {} is at least {:.4f}",
                       why, smallest, last.least);
  return fmt::format(
      "{}exact rays (footprint 0): there are too few rays to tell a bias so small (that of "
      "footprint {} may be {:.4f}); more pixels or samples can tell it",
      why, smallest, last.most);
}

}  // namespace

std::string footprint_text(float footprint) {
  return footprint > 0 ? fmt::format("footprint {}", footprint) : "exact rays (footprint 0)";
}

FootprintChoice choose_footprint(BiasSource& source, const FootprintDemand& demand) {
  if (demand.only_if_clear) return choose_if_clear(source, demand);
  FootprintChoice choice{demand.footprint, 0, {}};
  const double target = double{demand.target};
  Judgement last;
  for (; choice.footprint > 0; choice.footprint *= 0.5f) {
    if (choice.footprint < kSmallestPart * demand.footprint) choice.footprint = 0;
    if (choice.footprint == 0) break;
    if (demand.may_shrink && demand.max_bias > 0) {
      last = judge(source, choice.footprint, double{demand.max_bias});
      if (last.most > double{demand.max_bias}) continue;
    }
    if (demand.target <= 0) break;
    choice.bias_rmse = rmse_of(source, choice.footprint, target);
    if (!demand.may_shrink || choice.bias_rmse <= 0.5 * target) break;
  }
  if (choice.footprint == 0) choice.bias_rmse = 0;
  if (demand.may_shrink && (demand.max_bias > 0 || choice.footprint != demand.footprint))
    choice.note = note_of(demand, choice.footprint, last);
  if (!demand.may_shrink && choice.bias_rmse > kMostOfTarget * target)
    choice.note =
        fmt::format("the target {} cannot be reached with footprint {}, whose bias is about {:.4f}",
                    demand.target, choice.footprint, choice.bias_rmse);
  return choice;
}

}  // namespace dapple
