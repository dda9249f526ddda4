#include "compare/difference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "compare/worst_window.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

struct Sums {
  double a = 0.0, b = 0.0, difference = 0.0, squared = 0.0, relative = 0.0;
};

struct Worst {
  double difference = 0.0;
  const Plane* plane = nullptr;
  std::size_t pixel = 0;
};

/// Adds up a layer's values in one pass. Sums are doubles, since the rounding errors of floats add
/// up over a million pixels.
class Measurement {
 public:
  explicit Measurement(const LayerPair& layer) : squared_(layer.a.front()->pixels.size()) {
    worst_.plane = layer.a.front();
    for (std::size_t i = 0; i < layer.a.size(); ++i) add(*layer.a[i], *layer.b[i]);
  }

  [[nodiscard]] const Worst& worst() const { return worst_; }
  [[nodiscard]] std::vector<double> take_squared() { return std::move(squared_); }

  void fill(LayerDifference& d) const {
    const double count = static_cast<double>(std::max<std::size_t>(1, values_));
    d.values = values_;
    d.mean_a = sums_.a / count;
    d.mean_b = sums_.b / count;
    d.mean_difference = sums_.difference / count;
    d.rmse = std::sqrt(sums_.squared / count);
    d.relative_mse = sums_.relative / count;
    d.largest_b = values_ > 0 ? largest_b_ : 0.0;
    d.infinity_mismatches = infinity_mismatches_;
    d.nans = nans_;
  }

 private:
  void add(const Plane& plane_a, const Plane& plane_b) {
    for (std::size_t i = 0; i < squared_.size(); ++i) {
      const float a = plane_a.pixels[i];
      const float b = plane_b.pixels[i];
      if (std::isfinite(a) && std::isfinite(b)) {
        add_finite(a, b, plane_a, i);
      } else if (std::isnan(a) || std::isnan(b)) {
        ++nans_;
      } else if (a != b) {
        ++infinity_mismatches_;
      }
    }
  }

  void add_finite(double a, double b, const Plane& plane, std::size_t pixel) {
    const double difference = a - b;
    const double squared = difference * difference;
    ++values_;
    sums_.a += a;
    sums_.b += b;
    sums_.difference += difference;
    sums_.squared += squared;
    sums_.relative += squared / (b * b + kRelativeEpsilon);
    squared_[pixel] += squared;
    largest_b_ = std::max(largest_b_, b);
    if (std::abs(difference) > worst_.difference) {
      worst_ = {std::abs(difference), &plane, pixel};
    }
  }

  Sums sums_;
  Worst worst_;
  std::vector<double> squared_;  // summed over channels, for each pixel
  std::size_t values_ = 0, infinity_mismatches_ = 0, nans_ = 0;
  double largest_b_ = -HUGE_VAL;
};

std::string window_text(const Film& film) {
  const PixelRect& w = film.data_window;
  return fmt::format("{} x {} pixels from ({}, {}) of a picture of {} x {}", w.width(), w.height(),
                     w.x0, w.y0, film.width, film.height);
}

// Distances, positions, motions and counts are not in [0,1] like shades, so --max-rmse does not
// suit them.
bool is_exempt(const std::string& layer) {
  return layer == "Z" || layer == "P" || layer == "motion" || layer == "samples" ||
         layer == "visits" || layer.starts_with("crypto_");
}

}  // namespace

void require_same_windows(const Film& a, const Film& b, const std::string& name_a,
                          const std::string& name_b) {
  if (a.width == b.width && a.height == b.height && a.data_window == b.data_window) return;
  throw Error(ErrorKind::input,
              fmt::format("{} and {} show different parts of a picture: {}, against {}; render "
                          "both with the same --width, --height and --crop",
                          name_a, name_b, window_text(a), window_text(b)));
}

LayerDifference measure(const LayerPair& layer, const PixelRect& data_window) {
  const int width = data_window.width();
  assert(!layer.a.empty());
  LayerDifference d;
  d.layer = layer.name;
  Measurement measurement(layer);
  measurement.fill(d);
  if (layer.is_light() && d.largest_b > 0) d.rmse_of_largest = d.rmse / d.largest_b;

  const Worst& worst = measurement.worst();
  d.max_difference = worst.difference;
  d.max_channel = worst.plane->channel;
  d.max_x = data_window.x0 + static_cast<int>(worst.pixel % static_cast<std::size_t>(width));
  d.max_y = data_window.y0 + static_cast<int>(worst.pixel / static_cast<std::size_t>(width));

  const WorstWindow window =
      find_worst_window(measurement.take_squared(), width, data_window.height());
  const PixelRect& r = window.rect;
  const double window_values =
      static_cast<double>(r.width()) * r.height() * static_cast<double>(layer.a.size());
  d.window = {data_window.x0 + r.x0, data_window.y0 + r.y0, data_window.x0 + r.x1,
              data_window.y0 + r.y1};
  d.window_rmse = std::sqrt(window.sum / window_values);
  return d;
}

std::string failure(const Comparison& comparison, std::optional<double> max_rmse) {
  std::string reasons;
  const auto add = [&](const std::string& reason) {
    reasons += (reasons.empty() ? "" : "; ") + reason;
  };
  const bool only_exempt = std::all_of(comparison.layers.begin(), comparison.layers.end(),
                                       [](const auto& d) { return is_exempt(d.layer); });
  for (const LayerDifference& d : comparison.layers) {
    if (d.nans > 0) add(fmt::format("layer {} has {} NaN", d.layer, d.nans));
    if (!max_rmse || (is_exempt(d.layer) && !only_exempt)) continue;
    if (d.infinity_mismatches > 0) {
      add(fmt::format("layer {} has {} infinities that are not in both", d.layer,
                      d.infinity_mismatches));
    }
    if (d.rmse > *max_rmse) add(fmt::format("layer {} has RMSE {:.6g}", d.layer, d.rmse));
  }
  if (max_rmse) {
    for (const std::string& name : comparison.only_b) {
      if (only_exempt || !is_exempt(layer_of(name)))
        add(fmt::format("{} is only in {}", name, comparison.name_b));
    }
  }
  if (reasons.empty()) return {};
  const std::string limit = max_rmse ? fmt::format("; --max-rmse is {:.6g}", *max_rmse) : "";
  return fmt::format("{} and {} differ: {}{}", comparison.name_a, comparison.name_b, reasons,
                     limit);
}

}  // namespace dapple
