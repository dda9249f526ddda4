#include "device/upload/dome_upload.hpp"

#include "scene/images/color.hpp"
#include "scene/images/dome_image.hpp"

namespace dapple {
namespace {

/// Appends the running sums of `weights` divided by their total; equal steps when all are 0.
void append_cumulative(const std::vector<double>& weights, std::vector<float>& floats) {
  double total = 0;
  for (const double weight : weights) total += weight;
  double sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += total > 0 ? weights[i] / total : 1.0 / static_cast<double>(weights.size());
    floats.push_back(static_cast<float>(sum));
  }
  floats.back() = 1.0f;
}

void append_environment(const Environment& environment, std::vector<float>& floats) {
  std::vector<double> rows;
  std::vector<float> columns;
  for (std::uint32_t y = 0; y < environment.height; ++y) {
    std::vector<double> texels;
    double row = 0;
    for (std::uint32_t x = 0; x < environment.width; ++x) {
      texels.push_back(luminance(texel(environment, x, y)));
      row += texels.back();
    }
    rows.push_back(row * texel_solid_angle(environment, y));
    append_cumulative(texels, columns);
  }
  append_cumulative(rows, floats);
  floats.insert(floats.end(), columns.begin(), columns.end());
  for (const V3f& radiance : environment.radiance)
    floats.insert(floats.end(), {radiance.x, radiance.y, radiance.z});
}

}  // namespace

void pack_domes(const Scene& scene, std::vector<LightRecord>& records, std::vector<float>& floats) {
  const Environment uniform{1, 1, {V3f(1, 1, 1)}};
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (light.kind != LightKind::dome) continue;
    const Environment& environment = light.environment ? *light.environment : uniform;
    records[i].environment_first = static_cast<uint>(floats.size());
    records[i].environment_width = environment.width;
    records[i].environment_height = environment.height;
    records[i].rotation = light.rotation;
    append_environment(environment, floats);
  }
}

}  // namespace dapple
