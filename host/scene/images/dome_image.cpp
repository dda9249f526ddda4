// Reads the images of dome lights and prepares them for sampling. In: a path, or a scene with dome
// lights; out: an Environment, or the lights with images of mean luminance 1 and limited size.
#include "scene/images/dome_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "dapple/error.hpp"
#include "files/exr_reader.hpp"
#include "scene/images/radiance_hdr.hpp"
#include "scene/side_file.hpp"

namespace dapple {
namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 31;

/// Larger images are averaged down to at most this size: texels smaller than a sixth of a degree
/// make no visible difference to the light.
constexpr std::uint32_t kMaxWidth = 2048, kMaxHeight = 1024;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorKind::input, path + ": " + why);
}

bool is_exr(const std::vector<std::uint8_t>& bytes) {
  constexpr std::uint8_t kMagic[] = {0x76, 0x2f, 0x31, 0x01};
  return bytes.size() >= 4 && std::equal(std::begin(kMagic), std::end(kMagic), bytes.begin());
}

Environment environment_of(const ExrImage& image, const std::string& path) {
  const auto find = [&](const char* channel) {
    const auto found = image.channels.find(channel);
    return found == image.channels.end() ? nullptr : &found->second;
  };
  const std::vector<float>*r = find("R"), *g = find("G"), *b = find("B");
  if (const auto* y = find("Y"); y && !r && !g && !b) r = g = b = y;
  if (!r || !g || !b) refuse(path, "has neither channels R, G and B nor Y");
  Environment environment{image.width, image.height, {}};
  for (std::size_t i = 0; i < r->size(); ++i)
    environment.radiance.emplace_back((*r)[i], (*g)[i], (*b)[i]);
  return environment;
}

/// The largest radiance of a light, as in lights files: sums over lights and pixels stay finite.
constexpr float kMaxRadiance = 1e30f;

/// Sets negative values to 0. Throws Error input for values that no light may have.
void check_radiance(Environment& environment, const std::string& path) {
  for (std::size_t i = 0; i < environment.radiance.size(); ++i) {
    V3f& radiance = environment.radiance[i];
    for (int channel = 0; channel < 3; ++channel) {
      if (!std::isfinite(radiance[channel])) {
        refuse(path, fmt::format("pixel {}, {} is not finite", i % environment.width,
                                 i / environment.width));
      }
      if (radiance[channel] > kMaxRadiance) {
        refuse(path, fmt::format("pixel {}, {} is {:.3g}, above {:g}", i % environment.width,
                                 i / environment.width, radiance[channel], kMaxRadiance));
      }
      radiance[channel] = std::max(radiance[channel], 0.0f);
    }
  }
}

/// Returns the means over boxes of `across` x `down` texels, weighted by solid angle.
Environment averaged(const Environment& fine, std::uint32_t across, std::uint32_t down) {
  // Columns and rows that do not fill a box are added to the last box.
  Environment coarse{
      std::max(1u, fine.width / across), std::max(1u, fine.height / down), {}, fine.file};
  std::vector<V3d> sums(std::size_t{coarse.width} * coarse.height, V3d(0.0));
  std::vector<double> weights(sums.size(), 0.0);
  for (std::uint32_t y = 0; y < fine.height; ++y) {
    const double weight = texel_solid_angle(fine, y);
    const std::size_t row = std::min(y / down, coarse.height - 1);
    for (std::uint32_t x = 0; x < fine.width; ++x) {
      const std::size_t at = row * coarse.width + std::min(x / across, coarse.width - 1);
      sums[at] += V3d(texel(fine, x, y)) * weight;
      weights[at] += weight;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) coarse.radiance.emplace_back(sums[i] / weights[i]);
  return coarse;
}

double mean_luminance(const Environment& environment) {
  double sum = 0, weights = 0;
  for (std::uint32_t y = 0; y < environment.height; ++y) {
    const double weight = texel_solid_angle(environment, y);
    for (std::uint32_t x = 0; x < environment.width; ++x)
      sum += weight * luminance(texel(environment, x, y));
    weights += weight * environment.width;
  }
  return sum / weights;
}

void finalize_dome(Light& light) {
  Environment environment = *light.environment;
  const std::uint32_t across = (environment.width + kMaxWidth - 1) / kMaxWidth;
  const std::uint32_t down = (environment.height + kMaxHeight - 1) / kMaxHeight;
  if (across > 1 || down > 1) environment = averaged(environment, across, down);
  const double mean = mean_luminance(environment);
  const V3f& given = light.radiance;
  if (mean * std::max({given.x, given.y, given.z}) > kMaxRadiance) {
    refuse(environment.file.empty() ? light.name : environment.file,
           fmt::format("the dome's mean radiance is {:.3g} times {:.3g}, above {:g}", mean,
                       std::max({given.x, given.y, given.z}), kMaxRadiance));
  }
  light.radiance *= static_cast<float>(mean);
  if (!(mean > 0)) {
    light.environment = nullptr;
    return;
  }
  for (V3f& radiance : environment.radiance) radiance = V3f(V3d(radiance) / mean);
  light.environment = std::make_shared<const Environment>(std::move(environment));
}

}  // namespace

std::shared_ptr<const Environment> load_environment(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_side_file(path, "dome image", kMaxFileBytes);
  Environment environment;
  if (is_exr(bytes)) {
    environment = environment_of(read_exr_image(path), path);
  } else if (is_radiance_hdr(bytes)) {
    environment = decode_radiance_hdr(bytes, path);
  } else {
    refuse(path, "is neither an OpenEXR nor a Radiance HDR image");
  }
  check_radiance(environment, path);
  environment.file = path;
  return std::make_shared<const Environment>(std::move(environment));
}

void finalize_domes(Scene& scene) {
  for (Light& light : scene.lights)
    if (light.kind == LightKind::dome && light.environment) finalize_dome(light);
}

}  // namespace dapple
