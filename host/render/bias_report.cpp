#include "render/bias_report.hpp"

#include <utility>

#include "film/layers.hpp"
#include "render/unit_grid.hpp"

namespace dapple {

std::vector<std::string> bias_layers(const FilmLayout& layout, const std::vector<Light>& lights) {
  std::vector<std::string> names;
  if (layout.ao) names.emplace_back("ao");
  for (const std::string& name : light_names(lights)) names.push_back("light." + name);
  if (!layout.back_squares) return names;
  const std::size_t front = names.size();
  for (std::size_t i = 0; i < front; ++i) names.push_back(names[i] + ".back");
  return names;
}

std::vector<Bias> picture_bias(const BiasSums& sums, const HostView& film,
                               const std::vector<std::uint32_t>& samples, const FilmLayout& layout,
                               const View& view, const std::vector<double>& divisors) {
  if (sums.exact_rays == 0) return {};
  const std::span<const std::int64_t> hits = film.values<std::int64_t>().first(layout.pixels);
  const UnitGrid grid(view);
  std::vector<Bias> out;
  for (std::size_t layer = 0; layer < sums.differences.size(); ++layer) {
    std::vector<BiasUnit> units = grid.empty_units();
    for (std::uint32_t pixel = 0; pixel < layout.pixels; ++pixel) {
      const std::uint32_t taken =
          samples[pixel] - (sums.earlier.empty() ? 0u : sums.earlier[pixel]);
      if (hits[pixel] == 0 || taken == 0) continue;
      BiasUnit& unit = units[grid.unit(pixel)];
      unit.count += 1;
      unit.difference += double{sums.differences[layer][pixel]} / (taken * divisors[layer]);
    }
    out.push_back(estimate_bias(std::move(units), sums.exact_rays / sums.rays));
  }
  return out;
}

}  // namespace dapple
