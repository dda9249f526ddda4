// Values of some points that are also found exactly. In: the scene of the points, and the points.
// Out: the correction of each quantity, its bias, and the bias of any footprint.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "dapple/points.hpp"
#include "film/light_layers.hpp"
#include "points/bias_correction.hpp"
#include "points/point_sets.hpp"
#include "points/ring_rays.hpp"
#include "points/scene_of_points.hpp"
#include "sampling/footprint_choice.hpp"

namespace dapple {

/// The column of a ring's gap fraction, counted from 0 at the zenith.
std::string gap_name(std::size_t ring);

/// Of the lights of a layer, at point i.
Imath::V3d sum_of(const std::vector<PointIrradiance>& found, const LightLayer& layer,
                  std::vector<V3f> PointIrradiance::*which, std::size_t i);

class BiasSample : public BiasSource {
 public:
  /// No points are chosen where the rays are exact already. `on` must outlive the sample. What
  /// traces rays throws Error failed once `stop` returns true.
  BiasSample(const SceneOfPoints& on, std::span<const V3f> points, std::span<const V3f> normals,
             const PointOptions& options, Stop stop);

  [[nodiscard]] bool is_empty() const { return points_.empty(); }
  /// The sample has a fixed size.
  void grow(std::size_t) override {}
  [[nodiscard]] bool is_complete() const override { return true; }
  /// Layers are AO, the sky view factor, rings, lights and suns, as far as they are measured, first
  /// with tiles of neighbouring points, then with points as tiles and without means.
  std::vector<Bias> bias(float footprint) override;
  /// For the measurements from now on.
  void use_footprint(float footprint) { options_.footprint = footprint; }

  BiasCorrection of_ao() {
    return of_occlusion("ao", normals_, options_.distance, options_.falloff);
  }
  BiasCorrection of_sky_view_factor();
  std::vector<BiasCorrection> of_lights(const std::vector<LightLayer>& layers);
  std::vector<BiasCorrection> of_rings(const std::vector<ZenithRing>& rings);
  BiasCorrection of_suns();  ///< of their sum, when they are sampled

  /// What was measured so far, by quantity.
  [[nodiscard]] const std::map<std::string, Bias>& report() const { return bias_; }

 private:
  /// Values in [0,1] of one quantity, and the points of the sample that they are of.
  struct Values {
    std::vector<double> values;
    std::vector<std::uint32_t> points;
  };
  using Find = std::function<std::vector<Values>(const OcclusionOptions&)>;

  BiasCorrection of_occlusion(const std::string& name, const std::vector<V3f>& normals,
                              float distance, float falloff);
  [[nodiscard]] RenderControl control() const;
  std::vector<BiasCorrection> compare(const std::vector<std::string>& names, const Find& find);

  const SceneOfPoints& on_;
  PointOptions options_;
  Stop stop_;
  std::vector<V3f> points_, normals_;
  int sets_ = 0;
  double share_ = 0;                                  ///< of all values
  double share_of_points_ = 0;                        ///< of all points
  std::map<std::string, std::vector<Values>> exact_;  ///< by the first name of those compared
  std::map<std::string, Bias> bias_;
  std::vector<Bias> of_points_;  ///< what corrections leave, with points as tiles
};

}  // namespace dapple
