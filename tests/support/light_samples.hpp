// Samples of lights as the kernels take them, and the irradiance that they must integrate to.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "device/upload/light_upload.hpp"
#include "support/test_kernel.hpp"

namespace dapple::kernel_test {

/// Lambert's formula: irradiance at the origin, normal +Y, of a polygon of radiance 1 that
/// lies wholly above the horizon (Baum et al., "Improving Radiosity Solutions Through the
/// Use of Analytically Determined Form-Factors", 1989).
inline double polygon_irradiance(std::vector<V3d> corners) {
  for (V3d& c : corners) c.normalize();
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const V3d& a = corners[i];
    const V3d& b = corners[(i + 1) % corners.size()];
    const V3d edge = a.cross(b);
    sum += std::atan2(edge.length(), a.dot(b)) * edge.y / edge.length();
  }
  return std::fabs(sum) / 2;
}

struct Samples {
  std::vector<V3f> directions;
  std::vector<float> distances, solid_angles;

  /// Mean of weight times cosine: irradiance at the origin, normal +Y, radiance 1.
  [[nodiscard]] double irradiance() const {
    double sum = 0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      sum += solid_angles[i] * std::max(0.0f, directions[i].y);
    }
    return sum / static_cast<double>(directions.size());
  }
};

inline constexpr uint kLightSamples = 1u << 14;

inline Samples light_samples(const Scene& scene) {
  std::vector<LightRecord> records;
  std::vector<EmitterTriangle> emitters;
  pack_lights(scene, records, emitters);
  const Buffer directions = device().allocate(kLightSamples * sizeof(V3f));
  const Buffer distances = device().allocate(kLightSamples * sizeof(float));
  const Buffer solid_angles = device().allocate(kLightSamples * sizeof(float));
  run("sampling", "light_samples", kLightSamples,
      {upload(records), upload(emitters), directions, distances, solid_angles, 0u, kLightSamples});
  return {download<V3f>(directions, kLightSamples), download<float>(distances, kLightSamples),
          download<float>(solid_angles, kLightSamples)};
}

/// Relative error allowed for 16,384 points of a (0,2)-sequence on a smooth integrand.
inline constexpr double kIntegrationError = 3e-4;

inline Scene rect_scene(const V3f& position, const V3f& edge_u, const V3f& edge_v,
                        const V3f& direction) {
  Scene scene;
  Light light;
  light.kind = LightKind::rect;
  light.position = position;
  light.edge_u = edge_u;
  light.edge_v = edge_v;
  light.direction = direction.normalized();
  scene.lights.push_back(light);
  return scene;
}

}  // namespace dapple::kernel_test
