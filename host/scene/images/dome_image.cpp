// Reads the images of dome lights and prepares them for sampling. In: a path, or a scene with dome
// lights; out: an Environment, or the lights with images of mean luminance 1 and limited size.
#include "scene/images/dome_image.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "dapple/error.hpp"
#include "files/exr_color_space.hpp"
#include "files/exr_reader.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/images/color.hpp"
#include "scene/images/dome_rows.hpp"
#include "scene/images/radiance_hdr.hpp"
#include "scene/regular_file.hpp"

namespace dapple {
namespace {

constexpr FileKind kDomeImage{"dome image", std::uint64_t{1} << 31};

/// Rows of a strip: ZIP's blocks have 16, and OpenEXR decodes blocks of a strip side by side.
constexpr std::uint32_t kExrBlockRows = 16, kRadianceRows = 16;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorKind::input, path + ": " + why);
}

bool is_exr(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kMagic[] = {0x76, 0x2f, 0x31, 0x01};
  return bytes.size() >= 4 && std::equal(std::begin(kMagic), std::end(kMagic), bytes.begin());
}

/// The channels R, G and B, or Y for all three.
std::vector<ExrFile::Channel> color_channels(const ExrFile& file, const std::string& path) {
  std::vector<ExrFile::Channel> rgb, y;
  for (const ExrFile::Channel& channel : file.channels()) {
    if (channel.name == "R" || channel.name == "G" || channel.name == "B") rgb.push_back(channel);
    if (channel.name == "Y") y.push_back(channel);
  }
  if (rgb.size() == 3) return rgb;
  if (y.empty() || !rgb.empty()) refuse(path, "has neither channels R, G and B nor Y");
  return y;
}

Environment read_exr_dome(const std::string& path) {
  ExrFile file(path);
  const std::vector<ExrFile::Channel> channels = color_channels(file, path);
  const auto number_of = [&](const char* name) -> std::size_t {
    for (std::size_t i = 0; i < channels.size(); ++i)
      if (channels[i].name == name) return i;
    return 0;  // Y
  };
  const std::size_t r = number_of("R"), g = number_of("G"), b = number_of("B");
  if (is_cube_map(file.header()))
    refuse(path, "shows the sides of a cube (envmap); dapple reads latitude and longitude");
  const Imath::M33f to_linear_bt709 = to_bt709(file.header());
  if (!std::isfinite(to_linear_bt709.determinant()))
    refuse(path, "has chromaticities without an area");
  const bool converts = to_linear_bt709 != Imath::M33f();
  DomeRows dome(file.width(), file.height());
  std::vector<std::vector<float>> rows;
  std::vector<V3f> pixels;
  for (const DomeRows::Strip& strip : dome.strips(kExrBlockRows * dome.rows_of_texel())) {
    file.read(strip.first, strip.count, channels, rows);
    pixels.resize(rows[0].size());
    tbb::parallel_for(std::size_t{0}, pixels.size(), [&](std::size_t i) {
      const V3f pixel(rows[r][i], rows[g][i], rows[b][i]);
      pixels[i] = converts ? pixel * to_linear_bt709 : pixel;
    });
    dome.add(strip, pixels);
  }
  Environment environment = dome.take(path);
  environment.is_cropped = file.is_cropped();
  return environment;
}

Environment read_radiance_dome(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_regular_file(path, path, kDomeImage);
  if (!is_radiance_hdr(bytes)) refuse(path, "is neither an OpenEXR nor a Radiance HDR image");
  const RadianceImage image(bytes, path);
  DomeRows dome(image.width(), image.height());
  tbb::parallel_for_each(dome.strips(kRadianceRows), [&](const DomeRows::Strip& strip) {
    dome.add(strip, image.rows(strip.first, strip.count));
  });
  return dome.take(path);
}

/// The image, or a smaller one in its place (DomeRows).
Environment of_limited_size(Environment environment) {
  DomeRows dome(environment.width, environment.height);
  if (!dome.is_scaled()) return environment;
  for (const DomeRows::Strip& strip : dome.strips(environment.height))
    dome.add(strip, environment.radiance);
  Environment coarse = dome.take(environment.file);
  coarse.file = environment.file;
  coarse.negative_pixels = environment.negative_pixels;
  coarse.is_cropped = environment.is_cropped;
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
  constexpr std::uint64_t kStart = 16;
  Environment environment = is_exr(read_regular_file(path, path, kDomeImage, kStart))
                                ? read_exr_dome(path)
                                : read_radiance_dome(path);
  environment.file = path;
  return std::make_shared<const Environment>(std::move(environment));
}

Light dome_light(const std::string& name, const std::string& path) {
  Light dome;
  dome.name = name;
  dome.kind = LightKind::dome;
  dome.environment = load_environment(path);
  return dome;
}

void finalize_domes(Scene& scene) {
  check_lights(scene);
  for (Light& light : scene.lights) {
    if (light.kind != LightKind::dome || !light.environment) continue;
    const Environment& image = *light.environment;
    if (!image.file.empty() &&
        (image.width < 1.8 * image.height || image.width > 2.2 * image.height))
      scene.warnings.push_back(
          fmt::format("{}: it is not twice as wide as high; it is taken as longitude and latitude",
                      image.file));
    if (light.environment->is_cropped)
      scene.warnings.push_back(fmt::format(
          "{}: its data window, which is not its display window, is taken as the whole sphere",
          image.file));
    if (light.environment->negative_pixels > 0)
      scene.warnings.push_back(fmt::format("{}: pixels with negative radiance: {}; it counts as 0",
                                           light.environment->file,
                                           light.environment->negative_pixels));
    finalize_dome(light);
  }
}

}  // namespace dapple
