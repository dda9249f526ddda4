// Protocol "image": whole pictures, camera rays included, one pass at a time.
#pragma once

#include "rivals/contest.hpp"
#include "rivals/rival_scene.hpp"

namespace dapple::bench {

struct ImageOptions {
  int most_spp = 256;  ///< the ladder's end
  int reference_spp = 4096;
  std::string cache;  ///< folder of references
};

/// One pass of one scene, ready for its contest. Light values are relative to the largest
/// irradiance that any pixel would have unoccluded; several lights' pictures follow each other.
class ImageStudy {
 public:
  ImageStudy(RivalScene& scene, Pass pass, ImageOptions options);

  /// Embree, exact, at the reference's samples, from the cache where it is there.
  Truth truth();

  /// Embree's best of each alpha, found by trying all at a sample a pixel, for AO with one ray a
  /// sample and with two; dapple's exact and prefiltered; AO also by packets.
  std::vector<Contestant> contestants();

  /// How the contestants' camera rays are traced, and their occlusion rays, for the report.
  [[nodiscard]] const std::vector<PictureMethod>& methods() const { return methods_; }

 private:
  [[nodiscard]] RenderOptions render_options(int spp, std::uint32_t seed) const;
  void set_largest();
  void calibrate();
  Contestant by_embree(const PictureMethod& method);
  Outcome render(const RenderOptions& options);
  /// By a target, of pixels or of the picture: efforts are one over that, from `first` up.
  Contestant adaptive(const std::string& name, float RenderOptions::*target, double first);
  Contestant by_dapple(const std::string& name, const RenderOptions& changes);
  [[nodiscard]] std::vector<double> relative(std::vector<double> irradiance) const;
  [[nodiscard]] std::string reference_key() const;

  RivalScene& scene_;
  Pass pass_;
  ImageOptions options_;
  EmbreePictures pictures_;
  std::vector<double> largest_;  ///< by plane; 1 of AO
  std::vector<PictureMethod> methods_;
};

}  // namespace dapple::bench
