// A pilot that measures the bias of a picture before it is sampled. In: scene and options. Out: the
// bias of each layer for any footprint scale, by the same exact rays. Nothing is added to a film.
#pragma once

#include <vector>

#include "dapple/bias.hpp"
#include "passes/queues.hpp"
#include "render/bias/unit_grid.hpp"
#include "render/picture_rays.hpp"
#include "sampling/footprint_choice.hpp"

namespace dapple {

/// The arguments of the constructor must outlive the object.
class BiasPilot : public BiasSource {
 public:
  /// `camera`: parameters of the picture's camera pass.
  BiasPilot(DeviceContext& context, const DeviceBuffers& scene, const View& view,
            const RenderOptions& options, const FilmLayout& layout, const CameraParams& camera);

  /// Takes camera rays of more units, well spread over the picture, at most options.spp samples of
  /// a pixel, and traces their rays exactly.
  void grow(std::size_t rays) override;
  /// Takes at most this share of all camera rays, (0,1].
  void limit(double share);
  [[nodiscard]] bool is_complete() const override { return next_ >= most_units_; }
  /// Pixels that show geometry; for --target-error only these count.
  [[nodiscard]] double seen() const override;
  /// Of AO and of each light, as far as they have rays.
  std::vector<Bias> bias(float footprint) override;

 private:
  /// The rays of a layer, all samples in turn.
  struct Layer {
    OcclusionParams params{};
    std::vector<Ray> rays;
    std::vector<float> exact;        ///< transmittances
    std::vector<float> prefiltered;  ///< the same with `footprint`, of the first rays
    float footprint = -1;
    std::vector<std::uint32_t> units;  ///< by sample
  };

  [[nodiscard]] std::size_t rays() const;
  [[nodiscard]] std::size_t units_for(std::size_t rays) const;
  void take_units(std::size_t count);
  std::vector<std::uint32_t> count_hits(const std::vector<std::uint32_t>& units);
  void keep(Layer& layer, const std::vector<std::uint32_t>& units, const OcclusionParams& params);
  Bias bias_of(Layer& layer, bool is_light, float footprint);
  /// Appends the transmittances of those rays of the layer that `found` lacks.
  void trace(const Layer& layer, Estimator estimator, float footprint, std::vector<float>& found);

  DeviceContext& context_;
  const DeviceBuffers& scene_;
  const RenderOptions& options_;
  const FilmLayout& layout_;
  PictureRays picture_rays_;
  CameraParams camera_;
  UnitGrid grid_;
  std::vector<std::uint32_t> order_;  ///< units; any number of the first are evenly spread
  std::size_t units_at_once_;
  std::size_t next_ = 0;         ///< in order_, which is gone through again and again
  std::size_t most_units_;       ///< a unit may be taken once for each camera ray of a pixel
  std::vector<BiasUnit> units_;  ///< with counts of pixels that show geometry
  double seen_ = 0, tried_ = 0;
  std::vector<Layer> layers_;
  Queues queues_, traced_;
};

}  // namespace dapple
