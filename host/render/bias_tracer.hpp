// Traces a part of a picture's occlusion rays exactly, too. In: the queues of each slice after a
// prefiltered occlusion pass. Out: BiasSums. Nothing that the picture is made of changes.
#pragma once

#include <span>
#include <vector>

#include "camera/view.hpp"
#include "device/upload/scene_upload.hpp"
#include "film/bias_sums.hpp"
#include "passes/queues.hpp"
#include "sampling/exact_samples.hpp"

namespace dapple {

class BiasTracer {
 public:
  /// `layers`: number of layers of the picture. Continues `sums`.
  BiasTracer(DeviceContext& context, const DeviceBuffers& scene, const RenderOptions& options,
             const View& view, std::size_t layers, BiasSums sums);

  /// Chooses samples of a slice. `work`: of the slice's group.
  void choose(const SliceParams& slice, std::span<const PixelWork> work);
  /// Takes the rays of the chosen samples, whose transmittances are in queues.occlusions. `params`:
  /// of the pass that wrote them.
  void collect(std::size_t layer, const Queues& queues, const OcclusionParams& params);
  /// Traces the rays that were taken and not traced yet.
  void finish();
  [[nodiscard]] const BiasSums& sums() const { return sums_; }

 private:
  /// A sample of the slice whose rays are traced exactly.
  struct Chosen {
    std::uint32_t sample;  ///< index in the slice
    std::uint32_t pixel;   ///< in the crop
  };
  /// Rays of a layer that wait for being traced.
  struct Waiting {
    OcclusionParams params{};
    std::vector<Ray> rays;
    std::vector<Occlusion> prefiltered;  ///< by ray
    std::vector<std::uint32_t> pixels;   ///< by sample
    std::vector<float> factors;          ///< by sample: 1 / share
  };

  void trace(std::size_t layer);
  void add(std::size_t layer, std::span<const Occlusion> exact);

  DeviceContext& context_;
  const DeviceBuffers& scene_;
  const RenderOptions& options_;
  PixelRect crop_;
  std::uint32_t splitting_bits_;
  BiasSums sums_;
  double share_;  ///< of the samples that are chosen next
  std::vector<Chosen> chosen_;
  std::vector<Waiting> waiting_;  ///< by layer
  Queues queues_;                 ///< of exact rays
};

}  // namespace dapple
