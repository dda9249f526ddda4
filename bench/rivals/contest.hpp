// Compares contestants that estimate the same values. In: contestants and the true values. Out:
// time and error of each contestant at increasing effort, and the time that each needs to reach an
// error. Rounds are interleaved, so that changes of the machine's speed affect all contestants
// equally.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dapple::bench {

/// Reference values, and their mean variance.
struct Truth {
  std::vector<double> values;
  double variance = 0;
};

/// The mean of two independent estimates of equal effort, and its variance.
Truth truth_of_halves(const std::vector<double>& first, const std::vector<double>& second);

struct Outcome {
  double seconds = 0;          ///< wall time
  std::vector<double> values;  ///< as many as the truth has
};

struct Contestant {
  std::string name;
  bool is_embree = false;
  bool is_exact = false;       ///< must agree with the truth within its noise
  std::vector<double> ladder;  ///< efforts, increasing: rays per point, samples per pixel, ...
  std::function<Outcome(double effort, std::uint32_t seed)> run;
};

/// One contestant at one effort.
struct Rung {
  double effort = 0;
  double seconds = 0;                ///< median over the rounds
  double spread = 0;                 ///< (largest - smallest) / median of the seconds
  double rmse = 0;                   ///< median over the rounds, without the variance of the truth
  double mean_difference = 0;        ///< of the mean of all values, contestant minus truth
  double mean_difference_error = 0;  ///< its standard error
  int rounds = 0;
};

struct Standing {
  std::string name;
  bool is_embree = false, is_exact = false;
  std::vector<Rung> rungs;
};

struct ContestOptions {
  int rounds = 5;
  double stop_below = 0;  ///< contestants stop once their RMSE is below this
  std::function<void(const std::string&)> progress;
};

/// At each effort, runs all contestants in turn, several rounds. Contestants that take more than
/// ten seconds run only two rounds, because the machine's noise is small compared with their time.
std::vector<Standing> hold_contest(const std::vector<Contestant>& contestants, const Truth& truth,
                                   const ContestOptions& options);

/// Seconds to reach an error, interpolated linearly between logarithms.
struct TimeToError {
  double seconds = 0;
  bool extrapolated = false;  ///< beyond the last effort, by at most a factor of 2 in error
};

/// Nothing if the contestant does not reach the error, because of its bias or its last effort. If
/// it is below the error at its first effort, returns the seconds of that effort.
std::optional<TimeToError> time_to_error(const Standing& standing, double rmse);

/// The shortest time of Embree's contestants; nothing if none reaches the error.
std::optional<TimeToError> best_embree(const std::vector<Standing>& standings, double rmse);

/// A line for every exact contestant whose mean differs from the truth, at its last effort, by more
/// than four standard errors plus the bias of ending rays below the transmittance `black`. Empty if
/// all agree.
std::string disagreements(const std::vector<Standing>& standings, double black);

}  // namespace dapple::bench
