// How far two films are apart, layer by layer. In: the layers that both have. Out: figures
// of each, and whether they are within what was allowed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "compare/layers.hpp"

namespace dapple {

/// Keeps the relative error finite where B is black. Differences count as absolute below
/// sqrt(epsilon) = 0.1, as relative above.
inline constexpr double kRelativeEpsilon = 0.01;

/// Figures over all channels of a layer and those of its values that are finite in both films.
/// Positions are pixels of the display window, as `render --crop` takes them.
struct LayerDifference {
  std::string layer;
  std::size_t values = 0;  ///< that the figures are over
  double mean_a = 0.0;
  double mean_b = 0.0;
  double mean_difference = 0.0;  ///< of a - b
  double rmse = 0.0;
  double relative_mse = 0.0;              ///< mean of (a - b)^2 / (b^2 + kRelativeEpsilon)
  double largest_b = 0.0;                 ///< the largest finite value in B
  std::optional<double> rmse_of_largest;  ///< rmse / largest_b; lights alone, if B is not black
  double max_difference = 0.0;            ///< of |a - b|
  std::string max_channel;
  int max_x = 0;
  int max_y = 0;
  PixelRect window;                     ///< the window of kWindowSide that differs most
  double window_rmse = 0.0;             ///< values that are not finite count as equal here
  std::size_t infinity_mismatches = 0;  ///< values infinite in one film, not the same in the other
  std::size_t nans = 0;                 ///< values that are NaN in either film
};

struct Comparison {
  std::string name_a, name_b;
  int width = 0;  ///< of the data windows, which are equal
  int height = 0;
  std::vector<LayerDifference> layers;
  std::vector<std::string> only_a, only_b;  ///< see LayerMatch
};

/// Throws Error input, naming both sizes, unless the films' display and data windows agree.
void require_same_windows(const Film& a, const Film& b, const std::string& name_a,
                          const std::string& name_b);

/// `layer` is from match_layers of films whose data window is `data_window`.
LayerDifference measure(const LayerPair& layer, const PixelRect& data_window);

/// What keeps `comparison` from passing, in words; empty when it passes. NaN never passes.
/// Under a `max_rmse`, neither does a larger RMSE, nor infinity against anything else; Z, P
/// and samples are exempt from that, unless there are no other layers.
std::string failure(const Comparison& comparison, std::optional<double> max_rmse);

}  // namespace dapple
