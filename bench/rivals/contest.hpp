// A fair race: all contestants estimate the same values at rising effort, in turn, several times;
// what counts is how soon each comes below an error.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dapple::bench {

/// Values known well, and the mean variance of what is still unknown of one.
struct Truth {
  std::vector<double> values;
  double variance = 0;
};

/// Two independent estimates of equal effort -> their mean, and its variance.
Truth truth_of_halves(const std::vector<double>& first, const std::vector<double>& second);

struct Outcome {
  double seconds = 0;          ///< wall time
  std::vector<double> values;  ///< as many as the truth has
};

struct Contestant {
  std::string name;
  bool is_embree = false;
  bool is_exact = false;       ///< must agree with the truth within its noise
  std::vector<double> ladder;  ///< efforts, rising: rays a point, samples a pixel, ...
  std::function<Outcome(double effort, std::uint32_t seed)> run;
};

/// One contestant at one effort.
struct Rung {
  double effort = 0;
  double seconds = 0;                ///< median over the rounds
  double spread = 0;                 ///< (largest - smallest) / median of the seconds
  double rmse = 0;                   ///< of a value, the rounds' median, the truth's variance out
  double mean_difference = 0;        ///< of all values' mean, contestant minus truth
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
  double stop_below = 0;  ///< no higher effort for who has come below this RMSE
  std::function<void(const std::string&)> progress;
};

/// Round robin over contestants at each effort. Those that take longer than ten seconds run two
/// rounds only: noise of the machine is small beside them.
std::vector<Standing> hold_contest(const std::vector<Contestant>& contestants, const Truth& truth,
                                   const ContestOptions& options);

/// Seconds to an error, on a straight line between logarithms.
struct TimeToError {
  double seconds = 0;
  bool extrapolated = false;  ///< past the last effort, by no more than a factor 2 in error
};

/// Nothing where the contestant never gets there: its bias or its ladder ends above. Who begins
/// below it needs no more than the first effort's seconds, which are then the answer.
std::optional<TimeToError> time_to_error(const Standing& standing, double rmse);

/// The shortest of Embree's, nothing where none gets there.
std::optional<TimeToError> best_embree(const std::vector<Standing>& standings, double rmse);

/// A line for every exact contestant whose mean is further from the truth's, at its last effort,
/// than four standard errors and what cutting off rays below a transmittance of `black` explains;
/// empty: all agree.
std::string disagreements(const std::vector<Standing>& standings, double black);

}  // namespace dapple::bench
