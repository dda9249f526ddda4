// Traces a part of a picture's occlusion rays exactly, too. In: the queues of each slice after a
// prefiltered occlusion pass. Out: BiasSums. Nothing that the picture is made of changes.
#pragma once

#include <span>
#include <vector>

#include "camera/view.hpp"
#include "device/upload/scene_upload.hpp"
#include "film/sums/bias_sums.hpp"
#include "passes/queues.hpp"
#include "sampling/exact_samples.hpp"

namespace dapple {

class BiasTracer {
 public:
  /// `layers`: number of layers of the picture. Continues `sums`.
  BiasTracer(DeviceContext& context, const DeviceBuffers& scene, const RenderOptions& options,
             const View& view, std::size_t layers, BiasSums sums);

  /// Chooses samples of a slice, while the device may still trace its camera rays. `work`: of the
  /// slice's group.
  void choose(const SliceParams& slice, std::span<const PixelWork> work);
  /// Chooses points of flip_points_pass() in place of samples.
  void choose_backs(const BackParams& choice, std::span<const PixelWork> work);
  /// Keeps those of them that hit something, once the slice's hits are listed.
  void keep_hits(const Queues& queues);
  /// Takes the rays of the chosen samples, whose transmittances are in queues.occlusions. `params`:
  /// of the pass that wrote them.
  void collect(std::size_t layer, const Queues& queues, const OcclusionParams& params);
  /// Traces the rays that were taken and not traced yet.
  void finish();
  [[nodiscard]] const BiasSums& sums() const { return sums_; }

 private:
  /// Samples that a slice, or the packed slice of its backs, has of each entry. Where the slice
  /// begins at sample `first` of a pixel, sample i belongs to the camera ray, or group of samples,
  /// ((first >> group_bits) + i) >> ray_bits.
  struct EntrySamples {
    uint count, group_bits, ray_bits;
  };

  struct ChosenSample {
    std::uint32_t sample;  ///< in the slice
    std::uint32_t pixel;   ///< in the crop
  };

  /// Rays of a layer that lie on the device until there are enough to trace.
  struct PendingRays {
    OcclusionParams params{};
    Queues queues;                      ///< rays, and what the prefiltered pass found
    std::uint32_t count = 0;            ///< rays
    std::vector<std::uint32_t> pixels;  ///< by sample, in the crop
    std::vector<float> factors;         ///< by sample: 1 / share
  };

  /// The entries [begin, end) of a slice.
  struct Entries {
    std::uint32_t begin, end;
  };

  void choose_among(const SliceParams& slice, const EntrySamples& of_entry,
                    std::span<const PixelWork> work);
  [[nodiscard]] std::vector<ChosenSample> chosen_among(const SliceParams& slice,
                                                       const EntrySamples& of_entry,
                                                       std::span<const PixelWork> of_slice,
                                                       const Entries& entries) const;
  void trace(std::size_t layer);
  void add(std::size_t layer, std::span<const Ray> rays, std::span<const Occlusion> prefiltered,
           std::span<const Occlusion> exact);

  DeviceContext& context_;
  const DeviceBuffers& scene_;
  const RenderOptions& options_;
  PixelRect crop_;
  std::uint32_t splitting_bits_;
  BiasSums sums_;
  double share_;                              ///< of the samples that are chosen next
  std::size_t rays_at_once_;                  ///< of a layer
  std::vector<ChosenSample> chosen_samples_;  ///< of the slice
  float chosen_factor_ = 1;                   ///< inverse of the share by which they were chosen
  std::vector<std::uint32_t> chosen_slots_, chosen_pixels_;  ///< of the slice's chosen hits
  Buffer slots_;                                             ///< chosen_slots_ on the device
  std::vector<PendingRays> pending_;                         ///< by layer
  Buffer exact_;                                             ///< Occlusion of exact rays
  Buffer order_;                                             ///< of these rays, as in Queues
};

}  // namespace dapple
