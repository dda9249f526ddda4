// Chooses a footprint scale from its measured bias, before sampling starts. In: a pilot that can
// tell the bias of any scale, and what is demanded. Out: a scale, and the bias that a target must
// count.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dapple/bias.hpp"

namespace dapple {

/// Rays that are traced exactly and with any footprint.
class BiasSource {
 public:
  BiasSource() = default;
  BiasSource(const BiasSource&) = delete;
  BiasSource& operator=(const BiasSource&) = delete;
  virtual ~BiasSource() = default;

  /// Takes more rays until each layer has `rays`, or there are no more.
  virtual void grow(std::size_t rays) = 0;
  /// Whether there are no more.
  [[nodiscard]] virtual bool is_complete() const = 0;
  /// Of each layer, by the rays so far.
  virtual std::vector<Bias> bias(float footprint) = 0;
  /// Share of the values that a target counts and that can have a bias, [0,1].
  [[nodiscard]] virtual double seen() const { return 1; }
};

struct FootprintDemand {
  float footprint = 0;  ///< the largest scale
  float max_bias = 0;   ///< 0: any
  float target = 0;     ///< error of the values, bias included; 0: none
  bool may_shrink = true;
  /// Take a smaller scale only where the bias is clearly larger than max_bias.
  bool only_if_clear = false;
};

struct FootprintChoice {
  float footprint = 0;
  double bias_rmse = 0;  ///< that counts for the target, of the layer in which it is largest
  std::string note;      ///< for the user; may be empty
};

/// Smallest part of a demanded scale that is tried before 0.
inline constexpr float kSmallestPart = 1.0f / 16;

/// "footprint 0.5", or "exact rays (footprint 0)".
std::string footprint_text(float footprint);

/// The note where a limit is given and all rays are exact.
inline constexpr const char* kNothingToLimit =
    "--max-bias has no effect: nothing is computed that has a bias";

/// The largest of the scale, a half of it, ... a sixteenth and 0 whose bias is small enough: for
/// max_bias, in every layer |mean| + 2 standard errors; for a target, an RMSE of half of it. With
/// only_if_clear: the scale stays unless a layer's |mean| - 2 standard errors is above max_bias;
/// then |mean| becomes at most half of max_bias, or 0 with a sixteenth clearly above that.
FootprintChoice choose_footprint(BiasSource& source, const FootprintDemand& demand);

}  // namespace dapple
