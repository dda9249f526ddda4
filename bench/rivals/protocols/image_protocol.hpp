// Protocol "image": whole pictures of one pass, with their camera rays. In: a scene. Out: a
// reference picture, and contestants that render it with Embree and dapple.
#pragma once

#include "rivals/contest.hpp"
#include "rivals/rival_scene.hpp"

namespace dapple::bench {

struct ImageOptions {
  int most_spp = 256;  ///< samples per pixel at the largest effort
  int reference_spp = 4096;
  std::string cache;  ///< folder in which references are kept
};

/// The contest for one pass of one scene. Light values are relative to the largest unoccluded
/// irradiance of any pixel; the pictures of several lights follow each other.
class ImageStudy {
 public:
  ImageStudy(RivalScene& scene, Pass pass, ImageOptions options);

  /// Embree's exact picture with reference_spp samples, from the cache if it is there.
  Truth truth();

  /// The fastest method of Embree for each alpha, found by trying all methods with one sample per
  /// pixel; for AO with one ray per sample and with two. Then dapple's exact and prefiltered
  /// pictures.
  std::vector<Contestant> contestants();

  /// The methods of Embree's contestants, for the report.
  [[nodiscard]] const std::vector<PictureMethod>& methods() const { return methods_; }

 private:
  [[nodiscard]] RenderOptions render_options(int spp, std::uint32_t seed) const;
  void set_largest();
  void calibrate();
  Contestant by_embree(const PictureMethod& method);
  Outcome render(const RenderOptions& options);
  /// Renders to a target error of each pixel or of the picture. Efforts are the inverse of the
  /// target, increasing from `first`.
  Contestant adaptive(const std::string& name, float RenderOptions::*target, double first);
  Contestant by_dapple(const std::string& name, const RenderOptions& changes);
  [[nodiscard]] std::vector<double> relative(std::vector<double> irradiance) const;
  [[nodiscard]] std::string reference_key() const;

  RivalScene& scene_;
  Pass pass_;
  ImageOptions options_;
  EmbreePictures pictures_;
  std::vector<double> largest_;  ///< divisor of each plane; 1 for AO
  std::vector<PictureMethod> methods_;
};

}  // namespace dapple::bench
