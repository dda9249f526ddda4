#include "rivals/protocols/ray_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dapple::bench {

double best_embree_rate(const std::vector<RayRow>& rows) {
  double best = 0;
  for (const RayRow& row : rows)
    if (row.is_embree) best = std::max(best, row.rays_a_second);
  return best;
}

std::string disagreements(const std::vector<RayRow>& rows) {
  constexpr double kTolerance = 0.006;  // three standard errors of stochastic rays, 0.002 at most
  const auto exact =
      std::find_if(rows.begin(), rows.end(), [](const RayRow& row) { return row.name == "exact"; });
  std::string text;
  for (const RayRow& row : rows) {
    const bool should_agree = row.is_embree || row.name.starts_with("exact");
    if (exact == rows.end() || !should_agree ||
        std::fabs(row.mean_transmittance - exact->mean_transmittance) <= kTolerance)
      continue;
    text += fmt::format("warning: {} does not agree with exact: transmittance {:.4f}, not {:.4f}\n",
                        row.name, row.mean_transmittance, exact->mean_transmittance);
  }
  return text;
}

}  // namespace dapple::bench
