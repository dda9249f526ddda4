// Measures the differences of two films, layer by layer. In: the layers that both films have. Out:
// figures for each layer, and whether they are within the given limit.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "compare/layer_pairs.hpp"

namespace dapple {

/// Keeps the relative error finite where B is black. Differences count as absolute below
/// sqrt(epsilon) = 0.1, as relative above.
inline constexpr double kRelativeEpsilon = 0.01;

/// Figures over all channels of a layer and those of its values that are finite in both films.
/// Positions are pixels of the display window, as `render --crop` takes them.
struct LayerDifference {
  std::string layer;
  std::size_t values = 0;  ///< number of values that the figures include
  double mean_a = 0.0;
  double mean_b = 0.0;
  double mean_difference = 0.0;  ///< of a - b
  double rmse = 0.0;
  double relative_mse = 0.0;              ///< mean of (a - b)^2 / (b^2 + kRelativeEpsilon)
  double largest_b = 0.0;                 ///< the largest finite value in B
  std::optional<double> rmse_of_largest;  ///< rmse / largest_b; only for lights, B not black
  double max_difference = 0.0;            ///< of |a - b|
  std::string max_channel;
  int max_x = 0;
  int max_y = 0;
  PixelRect window;                     ///< see find_worst_window()
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

/// The figures of `layer`, which match_layers() made of two films with this data window.
LayerDifference measure(const LayerPair& layer, const PixelRect& data_window);

/// Why `comparison` fails, in words; empty when it passes. It fails if a layer has NaN. With a
/// `max_rmse` it also fails if a layer has a larger RMSE, if one has an infinity where the other
/// film has another value, or if A lacks a layer or channel that B has. Z, P, motion, samples,
/// visits and Cryptomattes are exempt from `max_rmse`, unless there are no other layers.
std::string failure(const Comparison& comparison, std::optional<double> max_rmse);

}  // namespace dapple
