// Rows of the protocol "rays": what each method of tracing prepared rays did. In: rows; out: the
// best of Embree's, and warnings.
#pragma once

#include <string>
#include <vector>

namespace dapple::bench {

struct RayRow {
  std::string name;
  bool is_embree = false;
  double rays_a_second = 0;       ///< median; for dapple by the device's clock, without copies
  double fastest_seconds = 0;     ///< of all rounds
  double spread = 0;              ///< (largest - smallest) / median of the seconds
  double mean_transmittance = 0;  ///< over all rays
  double visits = 0, tests = 0;   ///< per ray; only for dapple
};

/// 0 without rows of Embree.
double best_embree_rate(const std::vector<RayRow>& rows);

/// Lines that name rows which should have the mean of dapple's row "exact", and have not: what they
/// are fast at is something else.
std::string disagreements(const std::vector<RayRow>& rows);

}  // namespace dapple::bench
