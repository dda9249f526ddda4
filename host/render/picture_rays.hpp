// The occlusion rays of a picture: makes those of a slice's surface points. In: queues with points
// and the list of hits. Out: queues with rays, and the parameters of the pass that traces them.
#pragma once

#include <algorithm>
#include <limits>

#include "camera/view.hpp"
#include "dapple/options.hpp"
#include "device/upload/scene_upload.hpp"
#include "film/sums/film_sums.hpp"
#include "passes/queues.hpp"

namespace dapple {

/// The arguments of the constructor must outlive the object.
class PictureRays {
 public:
  /// `options`: by_sample(). At most `most` rays of a kind are made for each point, with the
  /// footprints of all that `options` say.
  PictureRays(DeviceContext& context, const DeviceBuffers& scene, const View& view,
              const RenderOptions& options, const FilmLayout& layout,
              int most = std::numeric_limits<int>::max())
      : context_(context),
        scene_(scene),
        options_(options),
        ao_rays_(std::min(options.ao_rays, most)),
        light_rays_(std::min(options.light_rays, most)),
        viewpoint_(dapple::viewpoint(view)),
        shaded_(layout.normals ? 1u : 0u) {}

  /// AO rays of `hits` points.
  OcclusionParams make_ao(const Queues& queues, std::uint32_t hits) const;
  /// Rays to one light.
  OcclusionParams make_light(const Queues& queues, std::uint32_t light, std::uint32_t hits) const;

  /// Where the points are seen from.
  [[nodiscard]] const Viewpoint& viewpoint() const { return viewpoint_; }

 private:
  [[nodiscard]] OcclusionParams occlusion_of(std::uint32_t points, int rays) const;

  DeviceContext& context_;
  const DeviceBuffers& scene_;
  const RenderOptions& options_;
  int ao_rays_, light_rays_;
  Viewpoint viewpoint_;
  uint shaded_;
};

}  // namespace dapple
