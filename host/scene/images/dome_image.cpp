// Reads the images of dome lights and prepares them for sampling. In: a path, or a scene with dome
// lights; out: an Environment, or the lights with images of mean luminance 1 and limited size.
#include "scene/images/dome_image.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
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
  Environment environment{image.width, image.height, std::vector<V3f>(r->size())};
  tbb::parallel_for(std::size_t{0}, r->size(), [&](std::size_t i) {
    environment.radiance[i] = V3f((*r)[i], (*g)[i], (*b)[i]);
  });
  return environment;
}

/// The largest radiance of a light, as in lights files: sums over lights and pixels stay finite.
constexpr float kMaxRadiance = 1e30f;

bool is_allowed(const V3f& radiance) {
  return std::max({radiance.x, radiance.y, radiance.z}) <= kMaxRadiance &&
         std::isfinite(radiance.x) && std::isfinite(radiance.y) && std::isfinite(radiance.z);
}

[[noreturn]] void refuse_pixel(const Environment& environment, std::size_t i,
                               const std::string& path) {
  const V3f& radiance = environment.radiance[i];
  const std::string pixel =
      fmt::format("pixel {}, {} is ", i % environment.width, i / environment.width);
  for (int channel = 0; channel < 3; ++channel)
    if (!std::isfinite(radiance[channel])) refuse(path, pixel + "not finite");
  const float largest = std::max({radiance.x, radiance.y, radiance.z});
  refuse(path, fmt::format("{}{:.3g}, above {:g}", pixel, largest, kMaxRadiance));
}

/// Sets negative values to 0 and counts their pixels. Throws Error input for values that no light
/// may have.
void check_radiance(Environment& environment, const std::string& path) {
  const std::size_t count = environment.radiance.size();
  std::atomic<std::size_t> negative = 0;
  const std::size_t first_refused = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count), count,
      [&](const tbb::blocked_range<std::size_t>& range, std::size_t first) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          V3f& radiance = environment.radiance[i];
          if (!is_allowed(radiance)) return std::min(first, i);
          if (std::min({radiance.x, radiance.y, radiance.z}) < 0) ++negative;
          for (int channel = 0; channel < 3; ++channel)
            radiance[channel] = std::max(radiance[channel], 0.0f);
        }
        return first;
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (first_refused < count) refuse_pixel(environment, first_refused, path);
  environment.negative_pixels = negative;
}

/// A row of means over boxes of `across` x `down` texels, weighted by solid angle. Columns and rows
/// that do not fill a box belong to the last box.
void average_row(const Environment& fine, std::uint32_t across, std::uint32_t down,
                 std::uint32_t row, Environment& coarse) {
  std::vector<V3d> sums(coarse.width, V3d(0.0));
  std::vector<double> weights(coarse.width, 0.0);
  const std::uint32_t end = row + 1 == coarse.height ? fine.height : (row + 1) * down;
  for (std::uint32_t y = row * down; y < end; ++y) {
    const double weight = texel_solid_angle(fine, y);
    for (std::uint32_t x = 0; x < fine.width; ++x) {
      const std::uint32_t at = std::min(x / across, coarse.width - 1);
      sums[at] += V3d(texel(fine, x, y)) * weight;
      weights[at] += weight;
    }
  }
  for (std::uint32_t x = 0; x < coarse.width; ++x)
    coarse.radiance[std::size_t{row} * coarse.width + x] = V3f(sums[x] / weights[x]);
}

/// The image, or one of at most kMaxWidth x kMaxHeight texels in its place.
Environment of_limited_size(Environment environment) {
  const std::uint32_t across = (environment.width + kMaxWidth - 1) / kMaxWidth;
  const std::uint32_t down = (environment.height + kMaxHeight - 1) / kMaxHeight;
  if (across <= 1 && down <= 1) return environment;
  Environment coarse{std::max(1u, environment.width / across),
                     std::max(1u, environment.height / down),
                     {},
                     environment.file,
                     environment.negative_pixels};
  coarse.radiance.resize(std::size_t{coarse.width} * coarse.height);
  tbb::parallel_for(0u, coarse.height, [&](std::uint32_t row) {
    average_row(environment, across, down, row, coarse);
  });
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
  Environment environment = of_limited_size(*light.environment);
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
  return std::make_shared<const Environment>(of_limited_size(std::move(environment)));
}

void finalize_domes(Scene& scene) {
  for (Light& light : scene.lights) {
    if (light.kind != LightKind::dome || !light.environment) continue;
    if (light.environment->negative_pixels > 0)
      scene.warnings.push_back(fmt::format("{}: pixels with negative radiance: {}; it counts as 0",
                                           light.environment->file,
                                           light.environment->negative_pixels));
    finalize_dome(light);
  }
}

}  // namespace dapple
