// The progress of a bake. In: numbers of samples that are finished, and the caller's functions.
// Out: a fraction for the caller's progress function, and whether the caller asks to stop.
#pragma once

#include <algorithm>
#include <cmath>

#include "dapple/render.hpp"

namespace dapple {

class BakeProgress {
 public:
  /// `samples`: expected in all.
  BakeProgress(double samples, const RenderControl& control) : total_(samples), control_(control) {}

  /// Adds samples that were not expected.
  void expect(double samples) { total_ += samples; }

  /// Adds traced samples. False if the bake is to stop.
  bool add(std::size_t samples) {
    done_ += static_cast<double>(samples);
    shown_ = std::max(shown_, std::min(std::nextafter(1.0, 0.0), done_ / std::max(1.0, total_)));
    show();
    return !(control_.stop && control_.stop());
  }

  /// To be called where no samples are traced for a while: after the question whether to stop, the
  /// caller takes the device to be at work until it is shown progress.
  void show() const {
    if (control_.progress) control_.progress(shown_);
  }

  /// All samples are traced, also if there were fewer than expected.
  void finish() {
    shown_ = 1;
    show();
  }

 private:
  double total_, done_ = 0, shown_ = 0;
  const RenderControl& control_;
};

}  // namespace dapple
