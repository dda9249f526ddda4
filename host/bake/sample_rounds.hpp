// Samples of a surface in rounds: some of each element, then more where values are uncertain. In: a
// surface, a tracer. Out: sums for its values. A batch is traced while the host adds up the one
// before.
#pragma once

#include <future>

#include "bake/bake_progress.hpp"
#include "bake/sampled_surface.hpp"
#include "bake/value_sums.hpp"

namespace dapple {

class SampleRounds {
 public:
  /// `hash`: random bits of the surface. All references must outlive the rounds.
  SampleRounds(const SampledSurface& surface, std::uint32_t hash, const Placements& placements,
               SampleTracer& tracer, ValueSums& sums, BakeProgress& progress)
      : surface_(surface),
        hash_(hash),
        placements_(placements),
        tracer_(tracer),
        sums_(sums),
        progress_(progress),
        taken_(surface.size()) {}

  /// As many samples as the options say: `first` of each element, then more until the standard
  /// error is their target, or `fixed` without a target. False: stopped.
  bool run(const BakeOptions& options, std::uint32_t first, SampleCounts fixed);

 private:
  struct SampleIndex {
    std::uint32_t element, number;
  };
  struct Batch {
    std::vector<SurfaceSample> samples;
    std::vector<std::uint32_t> placement;
    std::uint32_t hash = 0;
  };

  bool take(std::uint32_t samples, int rays);
  bool refine(float target, std::uint32_t max_samples);
  bool round(const std::vector<std::uint32_t>& wanted);
  [[nodiscard]] SurfaceSample sample(const SampleIndex& index) const;
  bool trace();

  const SampledSurface& surface_;
  std::uint32_t hash_, batch_ = 0;
  const Placements& placements_;
  SampleTracer& tracer_;
  ValueSums& sums_;
  BakeProgress& progress_;
  int rays_ = kRaysPerSample;
  std::vector<std::uint32_t> taken_;  ///< samples of each element
  std::vector<SampleIndex> next_;     ///< to be traced
  Batch batch_traced_;
  std::future<TracedSamples> traced_;  ///< last: its destructor waits for the thread
};

}  // namespace dapple
