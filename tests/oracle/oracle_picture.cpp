#include "oracle/oracle_picture.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dapple::oracle {
namespace {

V3d row(const M44f& m, int i) { return {m[i][0], m[i][1], m[i][2]}; }

/// The camera ray through (x, y): x to the right and y down, in [0,1) over the picture.
Segment camera_segment(const Camera& camera, double aspect, double x, double y) {
  const double half_height = std::tan(0.5 * camera.fov_y);
  const V3d direction = row(camera.to_world, 0) * ((2 * x - 1) * half_height * aspect) +
                        row(camera.to_world, 1) * ((1 - 2 * y) * half_height) -
                        row(camera.to_world, 2);
  return {V3f(row(camera.to_world, 3)), V3f(direction.normalized())};
}

/// An origin above the surface by several roundings of its position to float, so that the surface
/// does not occlude itself. Leaves are thousands of times further apart.
V3f start_of(const Hit& hit) {
  const V3d p = hit.start;
  const double largest = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return V3f(p + hit.facet * (largest * 1e-6));
}

/// A cosine-weighted direction: the normal plus a point of the unit sphere.
V3d cosine_direction(const V3d& normal, Random& random) {
  return (normal * (1 + 1e-9) + random.direction()).normalized();
}

/// Whether the surface hides a direction from its own point.
bool is_hidden(const Hit& hit, const V3d& direction) {
  return hit.hides && direction.dot(hit.facet) <= 0;
}

/// A / d^2 cos cos' for a uniformly chosen point of the rect. Sets `toward` to end at that point.
double sample_rect(const Light& rect, const Hit& hit, Random& random, Segment& toward) {
  const V3d to = V3d(rect.position) + V3d(rect.edge_u) * (random.real() - 0.5) +
                 V3d(rect.edge_v) * (random.real() - 0.5);
  const V3d way = to - V3d(toward.origin);
  const double distance = way.length();
  const V3d direction = way / distance;
  toward.direction = V3f(direction);
  toward.t_max = static_cast<float>(distance);
  const double area = V3d(rect.edge_u).cross(V3d(rect.edge_v)).length();
  const double at_light = std::max(0.0, -direction.dot(V3d(rect.direction)));
  const double at_surface =
      is_hidden(hit, direction) ? 0 : std::max(0.0, direction.dot(hit.normal));
  return area * at_light * at_surface / (distance * distance);
}

/// Samples of one quantity of one pixel.
struct Samples {
  double sum = 0, squares = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
  }
  void store(Estimate& estimate, std::size_t pixel, int count) const {
    const double mean = sum / count;
    estimate.pixels[pixel] = mean;
    estimate.variances[pixel] = std::max(0.0, squares / count - mean * mean) / (count - 1);
  }
};

class Artist {
 public:
  Artist(const EmbreeOracle& scene, const Camera& camera, int width, int height, int spp,
         const Light& rect)
      : scene_(scene), camera_(camera), rect_(rect), width_(width), height_(height), spp_(spp) {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (Estimate* estimate : {&picture_.ao, &picture_.light}) {
      estimate->pixels.resize(pixels);
      estimate->variances.resize(pixels);
    }
    unoccluded_.resize(pixels);
  }

  Picture draw(std::uint64_t seed) {
    tbb::parallel_for(std::size_t{0}, unoccluded_.size(), [&](std::size_t pixel) {
      draw_pixel(pixel, Random(Random(seed + pixel * 0x9e3779b9u).bits()));
    });
    picture_.brightest = *std::max_element(unoccluded_.begin(), unoccluded_.end());
    for (double& value : picture_.light.pixels) value /= picture_.brightest;
    for (double& value : picture_.light.variances) value /= picture_.brightest * picture_.brightest;
    return std::move(picture_);
  }

 private:
  void draw_pixel(std::size_t pixel, Random random) {
    const auto column = static_cast<double>(pixel % static_cast<std::size_t>(width_));
    const auto line = static_cast<double>(pixel / static_cast<std::size_t>(width_));
    Samples ao, light;
    for (int s = 0; s < spp_; ++s) {
      const Segment eye_ray =
          camera_segment(camera_, static_cast<double>(width_) / height_,
                         (column + random.real()) / width_, (line + random.real()) / height_);
      const std::optional<Hit> hit = scene_.first_hit(eye_ray, random.bits());
      if (!hit) {
        ao.add(1);
        light.add(0);
        continue;
      }
      const V3f start = start_of(*hit);
      const V3d direction = cosine_direction(hit->normal, random);
      ao.add(is_hidden(*hit, direction) ? 0 : scene_.transmittance({start, V3f(direction)}));
      Segment toward{start, V3f(0)};
      const double unoccluded = sample_rect(rect_, *hit, random, toward);
      unoccluded_[pixel] += unoccluded / spp_;
      light.add(unoccluded > 0 ? unoccluded * scene_.transmittance(toward) : 0);
    }
    ao.store(picture_.ao, pixel, spp_);
    light.store(picture_.light, pixel, spp_);
  }

  const EmbreeOracle& scene_;
  const Camera& camera_;
  const Light& rect_;
  int width_, height_, spp_;
  Picture picture_;
  std::vector<double> unoccluded_;
};

}  // namespace

double Estimate::mean() const {
  double sum = 0;
  for (const double value : pixels) sum += value;
  return sum / static_cast<double>(pixels.size());
}

double Estimate::standard_error() const {
  double sum = 0;
  for (const double variance : variances) sum += variance;
  return std::sqrt(sum) / static_cast<double>(pixels.size());
}

Picture draw(const EmbreeOracle& scene, const Camera& camera, int width, int height, int spp,
             const Light& rect, std::uint64_t seed) {
  return Artist(scene, camera, width, height, spp, rect).draw(seed);
}

}  // namespace dapple::oracle
