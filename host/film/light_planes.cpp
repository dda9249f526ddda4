#include "film/light_planes.hpp"

#include <algorithm>

#include "film/back_sources.hpp"

namespace dapple {
namespace {

/// The pixels whose sums of backs are used; empty: each pixel's own.
std::vector<std::uint32_t> sources_of_backs(const Sums& sums, const TracedPicture& picture,
                                            const FilmLayout& layout) {
  if (!layout.back_samples) return {};
  const auto has = [&](std::uint32_t p) { return sums.at(layout.back_samples, p) > 0; };
  const auto needs = [&](std::uint32_t p) { return picture.samples[p] > 0 && !has(p); };
  for (std::uint32_t p = 0; p < layout.pixels; ++p)
    if (needs(p)) return back_sources(layout.pixels, layout.width, needs, has);
  return {};
}

}  // namespace

LightPlanes::LightPlanes(const Sums& sums, const TracedPicture& picture, const FilmLayout& layout,
                         const RenderOptions& options, const std::vector<Light>& lights)
    : sums_(sums),
      picture_(picture),
      layout_(layout),
      lights_(lights),
      backs_(sources_of_backs(sums, picture, layout)),
      inverse_rays_(1.0 / options.light_rays) {}

V3d LightPlanes::sum(const std::vector<std::size_t>& lights, std::uint32_t pixel) const {
  const double samples = sample_count(picture_, pixel);
  V3d value(0.0);
  for (const std::size_t l : lights)
    value += of_planes({l, layout_.lights[l].first, layout_.lights[l].channels}, pixel, samples);
  return value;
}

V3d LightPlanes::reflected(const std::vector<std::size_t>& lights, std::uint32_t pixel) const {
  const double samples = sample_count(picture_, pixel);
  V3d value(0.0);
  for (const std::size_t l : lights)
    value += of_planes({l, layout_.lights[l].reflected(), DAPPLE_REFLECTED_PLANES}, pixel, samples);
  return value;
}

V3d LightPlanes::back(const std::vector<std::size_t>& lights, std::uint32_t pixel) const {
  const std::uint32_t source = back_source(pixel);
  const double samples = back_sample_count(sums_, layout_, source);
  V3d value(0.0);
  for (const std::size_t l : lights)
    value += of_planes({l, layout_.back_lights[l], layout_.lights[l].channels}, source, samples);
  return value;
}

double LightPlanes::unoccluded_percentile(double share) const {
  std::vector<double> values;
  for (std::uint32_t p = 0; p < layout_.pixels; ++p) {
    const double hits = sums_.at(DAPPLE_PLANE_HITS, p);
    if (hits == 0) continue;
    V3d value(0.0);
    for (std::size_t l = 0; l < lights_.size(); ++l)
      value += of_planes({l, layout_.lights[l].unoccluded(), layout_.lights[l].channels}, p, hits);
    const double largest = std::max({value.x, value.y, value.z});
    if (largest > 0) values.push_back(largest);
  }
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

V3d LightPlanes::of_planes(const Range& range, std::uint32_t pixel, double samples) const {
  const std::uint32_t last = range.channels - 1;
  const V3d sum(sums_.at(range.first, pixel), sums_.at(range.first + std::min(1u, last), pixel),
                sums_.at(range.first + last, pixel));
  return V3d(lights_[range.light].radiance) * sum *
         (inverse_rays_ / (layout_.lights[range.light].scale * samples));
}

}  // namespace dapple
