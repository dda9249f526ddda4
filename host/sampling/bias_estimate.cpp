#include "sampling/bias_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dapple {
namespace {

/// Sums over the units of a tile.
struct TileSums {
  double units = 0, count = 0, difference = 0;
  double squared_counts = 0, squared_differences = 0, products = 0;

  void add(const BiasUnit& unit) {
    units += 1;
    count += unit.count;
    difference += unit.difference;
    squared_counts += unit.count * unit.count;
    squared_differences += unit.difference * unit.difference;
    products += unit.count * unit.difference;
  }

  /// Variance of `difference`, from how its units deviate from `mean` per value; of a tile of
  /// several units from the tile's own mean.
  [[nodiscard]] double variance(double mean_of_all) const {
    const double mean = units > 1 ? difference / count : mean_of_all;
    const double deviations =
        squared_differences - 2 * mean * products + mean * mean * squared_counts;
    return std::max(0.0, deviations) * (units > 1 ? units / (units - 1) : 1);
  }
};

std::vector<TileSums> tile_sums(std::vector<BiasUnit> units) {
  std::erase_if(units, [](const BiasUnit& unit) { return !(unit.count > 0); });
  std::stable_sort(units.begin(), units.end(),
                   [](const BiasUnit& a, const BiasUnit& b) { return a.tile < b.tile; });
  std::vector<TileSums> tiles;
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (i == 0 || units[i].tile != units[i - 1].tile) tiles.emplace_back();
    tiles.back().add(units[i]);
  }
  return tiles;
}

/// A mean square and its standard error.
struct MeanSquare {
  double value = 0, error = 0;
};

/// The mean square of the tiles' biases. Products of different units have no noise in the mean,
/// squares of one unit would: so a tile of one unit does not count.
MeanSquare tile_mean_square(const std::vector<TileSums>& tiles, double mean_of_all) {
  double count = 0, squares = 0, variance = 0;
  for (const TileSums& tile : tiles) {
    const double pairs = tile.count * tile.count - tile.squared_counts;
    if (tile.units < 2 || !(pairs > 0)) continue;
    const double square = (tile.difference * tile.difference - tile.squared_differences) / pairs;
    const double noise = tile.variance(mean_of_all) / (tile.count * tile.count);
    count += tile.count;
    squares += tile.count * square;
    variance += tile.count * tile.count * (2 * noise * noise + 4 * std::max(0.0, square) * noise);
  }
  if (count == 0) return {};
  return {squares / count, std::sqrt(variance) / count};
}

}  // namespace

Bias estimate_bias(std::vector<BiasUnit> units, double share) {
  Bias bias;
  bias.share = share;
  const std::vector<TileSums> tiles = tile_sums(std::move(units));
  double count = 0, difference = 0, variance = 0;
  for (const TileSums& tile : tiles) {
    count += tile.count;
    difference += tile.difference;
  }
  if (count == 0) return bias;
  bias.mean = difference / count;
  for (const TileSums& tile : tiles) variance += tile.variance(bias.mean);
  bias.error = std::sqrt(variance) / count;
  const MeanSquare square = tile_mean_square(tiles, bias.mean);
  bias.tile_rmse = std::sqrt(std::max(0.0, square.value));
  bias.tile_rmse_limit = std::sqrt(std::max(0.0, square.value) + 2 * square.error);
  return bias;
}

double mean_square(const Bias& bias) {
  return std::max(
      {0.0, bias.mean * bias.mean - bias.error * bias.error, bias.tile_rmse * bias.tile_rmse});
}

double error_of_mean_square(const Bias& bias) {
  const double of_mean = bias.error * (2 * std::fabs(bias.mean) + bias.error);
  const double of_tiles =
      0.5 * (bias.tile_rmse_limit * bias.tile_rmse_limit - bias.tile_rmse * bias.tile_rmse);
  return std::max(of_mean, of_tiles);
}

double bias_error(double spread, double count, double rays) {
  constexpr double kFewestValues = 8;
  return std::hypot(count < kFewestValues ? 1 / std::sqrt(rays) : spread, 1 / rays);
}

std::string bias_text(const Bias& bias) {
  return fmt::format("{:+.4f} +- {:.4f}, RMSE over tiles {:.4f}", bias.mean, bias.error,
                     bias.tile_rmse);
}

float noise_target(float target, double bias_rmse) {
  const double square = double{target} * target - bias_rmse * bias_rmse;
  return static_cast<float>(std::sqrt(std::max(square, 0.25 * target * target)));
}

}  // namespace dapple
