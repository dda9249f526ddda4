#include "rivals/contest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>

#include "accuracy/pixel_statistics.hpp"

namespace dapple::bench {
namespace {

/// Time for the threads of the previous contestant to become idle.
constexpr auto kPause = std::chrono::milliseconds(2);

constexpr double kLongSeconds = 10, kShortSeconds = 0.5;

/// Seed of the contestants' first round. The truth uses other seeds.
constexpr std::uint32_t kFirstSeed = 1000;

/// One contestant's rounds at one effort.
class RungSums {
 public:
  RungSums(double effort, const Truth& truth) : effort_(effort), truth_(truth) {}

  void add(const Outcome& outcome) {
    seconds_.push_back(outcome.seconds);
    double squares = 0;
    for (std::size_t i = 0; i < truth_.values.size(); ++i) {
      const double error = outcome.values[i] - truth_.values[i];
      sum_ += error;
      squares += error * error;
    }
    square_errors_.push_back(squares / static_cast<double>(truth_.values.size()));
  }

  [[nodiscard]] bool is_long() const {
    return seconds_.size() >= 2 && median(seconds_) > kLongSeconds;
  }

  [[nodiscard]] Rung rung() const {
    const auto values = static_cast<double>(truth_.values.size());
    const auto rounds = static_cast<double>(seconds_.size());
    Rung rung;
    rung.effort = effort_;
    rung.seconds = median(seconds_);
    const auto [least, most] = std::minmax_element(seconds_.begin(), seconds_.end());
    rung.spread = (*most - *least) / rung.seconds;
    rung.rmse = std::sqrt(std::max(0.0, median(square_errors_) - truth_.variance));
    rung.mean_difference = sum_ / (values * rounds);
    const double square =
        std::accumulate(square_errors_.begin(), square_errors_.end(), 0.0) / rounds;
    rung.mean_difference_error = std::sqrt(
        std::max(0.0, square - truth_.variance) / (values * rounds) + truth_.variance / values);
    rung.rounds = static_cast<int>(rounds);
    return rung;
  }

 private:
  double effort_;
  const Truth& truth_;
  std::vector<double> seconds_;
  std::vector<double> square_errors_;  // mean over the values, by round
  double sum_ = 0;
};

/// Whether the contestant runs at another effort.
bool goes_on(const Contestant& contestant, const Standing& standing, std::size_t step,
             double stop_below) {
  if (step >= contestant.ladder.size()) return false;
  return standing.rungs.empty() || standing.rungs.back().rmse >= stop_below;
}

/// Runs the contestant once without measuring, if that is cheap: this compiles kernels and fills
/// caches.
void warm_up(const Contestant& contestant, const Standing& standing, double effort) {
  if (standing.rungs.empty() || standing.rungs.back().seconds < kShortSeconds)
    contestant.run(effort, kFirstSeed - 1);
}

}  // namespace

Truth truth_of_halves(const std::vector<double>& first, const std::vector<double>& second) {
  Truth truth;
  double squares = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    truth.values.push_back(0.5 * (first[i] + second[i]));
    squares += (first[i] - second[i]) * (first[i] - second[i]);
  }
  truth.variance = 0.25 * squares / static_cast<double>(first.size());
  return truth;
}

std::vector<Standing> hold_contest(const std::vector<Contestant>& contestants, const Truth& truth,
                                   const ContestOptions& options) {
  std::vector<Standing> standings;
  for (const Contestant& c : contestants)
    standings.push_back({c.name, c.is_embree, c.is_exact, {}});
  for (std::size_t step = 0;; ++step) {
    std::vector<std::size_t> active;
    std::vector<RungSums> sums;
    for (std::size_t c = 0; c < contestants.size(); ++c) {
      if (!goes_on(contestants[c], standings[c], step, options.stop_below)) continue;
      active.push_back(c);
      sums.emplace_back(contestants[c].ladder[step], truth);
      warm_up(contestants[c], standings[c], contestants[c].ladder[step]);
    }
    if (active.empty()) return standings;
    for (int round = 0; round < options.rounds; ++round) {
      for (std::size_t i = 0; i < active.size(); ++i) {
        if (sums[i].is_long()) continue;
        const Contestant& contestant = contestants[active[i]];
        if (options.progress)
          options.progress(fmt::format("{}, effort {:g}, round {}", contestant.name,
                                       contestant.ladder[step], round + 1));
        std::this_thread::sleep_for(kPause);
        sums[i].add(contestant.run(contestant.ladder[step],
                                   kFirstSeed + static_cast<std::uint32_t>(round)));
      }
    }
    for (std::size_t i = 0; i < active.size(); ++i)
      standings[active[i]].rungs.push_back(sums[i].rung());
  }
}

std::optional<TimeToError> time_to_error(const Standing& standing, double rmse) {
  const std::vector<Rung>& rungs = standing.rungs;
  if (rungs.empty()) return std::nullopt;
  if (rungs[0].rmse <= rmse) return TimeToError{rungs[0].seconds, false};
  const auto between = [&](const Rung& a, const Rung& b) {
    const double share = std::log(rmse / a.rmse) / std::log(std::max(b.rmse, 1e-12) / a.rmse);
    return a.seconds * std::pow(b.seconds / a.seconds, share);
  };
  for (std::size_t i = 1; i < rungs.size(); ++i)
    if (rungs[i].rmse <= rmse) return TimeToError{between(rungs[i - 1], rungs[i]), false};
  // Noise decreases with the inverse root of the effort. A slower decrease shows a bias, which must
  // not be extrapolated.
  if (rungs.size() < 2 || rungs.back().rmse > 2 * rmse) return std::nullopt;
  const Rung &a = rungs[rungs.size() - 2], &b = rungs.back();
  const double slope = std::log(b.rmse / a.rmse) / std::log(b.effort / a.effort);
  if (slope > -0.4) return std::nullopt;
  return TimeToError{between(a, b), true};
}

std::optional<TimeToError> best_embree(const std::vector<Standing>& standings, double rmse) {
  std::optional<TimeToError> best;
  for (const Standing& standing : standings) {
    if (!standing.is_embree) continue;
    const auto found = time_to_error(standing, rmse);
    if (found && (!best || found->seconds < best->seconds)) best = found;
  }
  return best;
}

std::string disagreements(const std::vector<Standing>& standings, double black) {
  std::string text;
  for (const Standing& standing : standings) {
    if (!standing.is_exact || standing.rungs.empty()) continue;
    const Rung& last = standing.rungs.back();
    const double most = 4 * last.mean_difference_error + 0.5 * black;
    if (std::fabs(last.mean_difference) <= most) continue;
    text += fmt::format(
        "warning: {}: the mean is {:+.5f} from the reference's, standard error {:.5f}: one of the "
        "two is wrong\n",
        standing.name, last.mean_difference, last.mean_difference_error);
  }
  return text;
}

}  // namespace dapple::bench
