// Shows the progress of a command: on a terminal a bar with the estimated time, elsewhere a line
// every ten seconds.
#pragma once

#include <chrono>
#include <string>

#include "dapple/render.hpp"

namespace dapple {

class ProgressBar {
 public:
  /// Prints nothing if `quiet`. `verb`: what is going on, such as "rendering".
  ProgressBar(bool quiet, std::string verb);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double done);
  /// Says what is done before or between, such as "reading" "tree.glb", if that is on a terminal.
  /// Of a path only the name is said, so that it fits into a line.
  void announce(const std::string& doing, const std::string& path);
  /// Starts the bar of the next of several renders; `what` is its title.
  void begin(const std::string& what);
  /// Erases the bar, so that other text can follow.
  void clear();
  [[nodiscard]] Progress callback() {
    return [this](double done) { show(done); };
  }

 private:
  std::string verb_;
  bool quiet_, terminal_, drawn_ = false;
  std::string what_;
  double begun_ = -1;  ///< progress at the first call of show()
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace dapple
