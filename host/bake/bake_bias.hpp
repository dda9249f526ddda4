// The bias of a bake: a part of its samples is traced exactly, too. In: functions that trace
// samples. Out: a function that returns the prefiltered values unchanged, and the bias of each
// quantity.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "bake/samples/sample_tracer.hpp"
#include "dapple/bias.hpp"
#include "render/stopwatch.hpp"
#include "sampling/bias_estimate.hpp"

namespace dapple {

/// Whether values by these options may differ from the truth by more than noise.
inline bool has_bias(const BakeOptions& options) {
  return options.estimator == Estimator::prefiltered && options.footprint > 0;
}

/// How samples of a quantity, "ao" or "light", are traced.
struct BiasTracing {
  std::string name;
  TraceSamples values;              ///< as they are baked
  TraceSamples prefiltered, exact;  ///< to be compared; exact tells what is inside
};

/// Functions must be called one after the other.
class BakeBias {
 public:
  /// `share`: of the samples, [0,1].
  explicit BakeBias(double share) : most_(share), share_(share) {}
  BakeBias(const BakeBias&) = delete;
  BakeBias& operator=(const BakeBias&) = delete;

  /// Whether samples may be compared.
  [[nodiscard]] bool compares() const { return most_ > 0; }
  /// tracing.values, which also compares, for one mesh. The object must outlive the function.
  TraceSamples with(BiasTracing tracing);
  /// By quantity; without those of which too little was compared to tell an error.
  [[nodiscard]] std::map<std::string, Bias> report() const;

 private:
  /// Of a mesh.
  struct Compared {
    std::vector<BiasUnit> units;  ///< without empty ones
    double samples = 0, compared = 0;
    double rays = 0;  ///< that were compared
  };
  struct Quantity {
    std::deque<Compared> meshes;  ///< references stay valid
    float largest = 0;            ///< without occlusion
  };

  void compare(const BiasTracing& tracing, std::span<const SurfaceSample> samples,
               std::span<const std::uint32_t> placement, const Placements& placements, int rays,
               std::uint32_t hash, Compared& mesh);
  [[nodiscard]] static std::vector<BiasUnit> units_of(const Quantity& quantity);
  void limit_time();

  double most_, share_;  ///< of the samples: at most, and of the next ones
  std::uint32_t next_block_ = 0;
  double seconds_ = 0, compared_seconds_ = 0;
  double samples_ = 0, compared_samples_ = 0;
  std::map<std::string, Quantity> quantities_;
};

/// Differences between prefiltered and exact values of samples, by blocks of consecutive ones.
/// Without samples inside closed geometry, which `exact` tells: they count for no value.
std::vector<BiasUnit> differences(std::span<const SurfaceSample> samples,
                                  const TracedSamples& prefiltered, const TracedSamples& exact);

}  // namespace dapple
