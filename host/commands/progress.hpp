// How far a render is: a bar with an estimate on a terminal, a line now and then elsewhere.
#pragma once

#include <chrono>
#include <string>

#include "dapple/render.hpp"

namespace dapple {

class ProgressBar {
 public:
  /// Says nothing when `quiet`.
  explicit ProgressBar(bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double done);
  /// Begins anew with the next of several renders, of which the bar says `what` it is.
  void begin(const std::string& what);
  /// Erases the bar, so that other text can follow.
  void clear();
  [[nodiscard]] Progress callback() {
    return [this](double done) { show(done); };
  }

 private:
  bool quiet_, terminal_, drawn_ = false;
  std::string what_;
  double begun_ = -1;  ///< what was done when it was first told
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace dapple
