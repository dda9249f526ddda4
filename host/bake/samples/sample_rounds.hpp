// Samples of a surface in rounds: some of each element, then more where values are uncertain. In: a
// surface, a tracer. Out: sums for its values. A batch is traced while the host adds up the one
// before.
#pragma once

#include <future>

#include "bake/bake_progress.hpp"
#include "bake/samples/error_check.hpp"
#include "bake/samples/placement_variance.hpp"
#include "bake/samples/sampled_surface.hpp"
#include "bake/samples/value_sums.hpp"

namespace dapple {

/// The tracers of AO or of lights.
struct QuantityTracing {
  TraceSamples values;    ///< of samples that values are made of; their bias is reported
  TraceSamples of_check;  ///< of the second set: error_check.hpp
};

/// The tracers of a bake, and its callbacks.
struct BakeTracing {
  QuantityTracing ao;
  QuantityTracing light;
  std::size_t lights = 0;  ///< their number; 0: they are not baked, and `light` is empty
  BakeProgress& progress;
  BakeStatistics& statistics;
};

/// How many samples and rays to take.
struct RoundOptions {
  float target_error = 0;     ///< 0: `fixed` samples of each element
  std::uint32_t first = 1;    ///< samples of each element before the first error is known, or more
  std::uint32_t limit = 128;  ///< samples of an element, with a target
  int rays = kRaysPerSample;  ///< of a sample, with a target
  SampleCounts fixed = {};
};

class SampleRounds {
 public:
  /// `hash`: random bits of the surface. `ao`: lights are traced, and these are the values of AO;
  /// null: AO is traced. All references must outlive the rounds.
  SampleRounds(const SampledSurface& surface, std::uint32_t hash, const Placements& placements,
               BakeTracing& tracing, ValueSums& sums, BakeSides sides,
               const ValueSums* ao = nullptr);

  /// Takes samples as the options say. False: stopped.
  bool run(const RoundOptions& options);

 private:
  struct SampleIndex {
    std::uint32_t element, number;
    std::uint32_t sequence = 0;  ///< SampledSurface::sample(); 1: of the second set
  };
  struct Batch {
    std::vector<SampleIndex> indices;
    std::vector<SurfaceSample> samples;
    std::vector<std::uint32_t> placement;
    std::uint32_t hash = 0;
  };

  [[nodiscard]] std::uint32_t first_samples(std::uint32_t least) const;
  bool take(std::uint32_t samples, int rays);
  bool refine(std::uint32_t max_samples);
  double double_missing(std::vector<std::uint32_t>& wanted, std::uint32_t max_samples) const;
  void count_values(std::uint32_t max_samples);
  bool round(const std::vector<std::uint32_t>& wanted);
  [[nodiscard]] std::uint32_t placements() const {
    return static_cast<std::uint32_t>(placements_.to_world.size());
  }
  [[nodiscard]] SurfaceSample sample(const SampleIndex& index) const;
  [[nodiscard]] Batch make_batch(std::vector<SampleIndex> indices);
  bool trace();
  void trace_second_set();
  void judge();
  [[nodiscard]] TracedSamples traced(const Batch& batch, const TraceSamples& trace) const;
  void add_traced(const Batch& batch, const TracedSamples& found);
  void count(const TracedSamples& found);
  void set_variance_factors();

  const SampledSurface& surface_;
  std::uint32_t hash_, batch_ = 0;
  const Placements& placements_;
  BakeTracing& tracing_;
  const QuantityTracing& trace_;
  ValueSums& sums_;
  const ValueSums* ao_;              ///< null: AO is traced, not lights
  std::size_t lights_;               ///< rays to lights are that many times as many
  std::size_t samples_at_once_ = 1;  ///< for take()'s rays
  int rays_ = kRaysPerSample;
  float target_error_ = 0;             ///< 0: none
  bool is_in_all_placements_ = false;  ///< each point of an element is a sample in all placements
  PlacementVariance variance_;
  ErrorCheck check_;
  std::vector<std::uint32_t> checked_;  ///< samples of each of its elements
  std::vector<std::uint32_t> taken_;    ///< samples of each element
  std::vector<SampleIndex> next_;       ///< to be traced
  Batch batch_traced_;
  std::future<TracedSamples> traced_;  ///< last: its destructor waits for the thread
};

}  // namespace dapple
