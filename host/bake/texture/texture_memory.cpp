#include "bake/texture/texture_memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Measured with textures of 1024 to 4096 texels a side: of a covered texel, and of any.
constexpr double kBytesOfCovered = 130, kBytesOfTexel = 24;
/// Sums and values of a light, of both sides, and of a bent normal.
constexpr double kBytesOfLight = 36, kBytesOfBent = 12;

/// The part of the texture that the triangles of one mesh cover at most, [0,1].
double largest_coverage(const TextureLayout& layout) {
  double largest = 0;
  for (const std::vector<V2f>& corners : layout.corners) {
    double area = 0;
    for (std::size_t t = 0; t + 2 < corners.size(); t += 3)
      area +=
          0.5 * std::fabs(double{(corners[t + 1] - corners[t]).cross(corners[t + 2] - corners[t])});
    largest = std::max(largest, area);
  }
  return std::min(1.0, largest);
}

}  // namespace

double texture_bake_bytes(const TextureLayout& layout, const BakeOptions& options,
                          std::size_t lights) {
  const double texels = double{1.0 * options.texture_size} * options.texture_size;
  const double of_lights = options.light ? kBytesOfLight * static_cast<double>(lights) : 0.0;
  return texels * (largest_coverage(layout) * (kBytesOfCovered + of_lights) + kBytesOfTexel +
                   (options.bent ? kBytesOfBent : 0.0) + of_lights / 3);
}

void check_texture_memory(const TextureLayout& layout, const BakeOptions& options,
                          std::size_t lights, double machine) {
  constexpr double kGigabyte = 1e9;
  const double bytes = texture_bake_bytes(layout, options, lights);
  if (!(machine > 0) || bytes <= machine) return;
  throw Error(ErrorKind::usage,
              fmt::format("--size {}: the texture takes {:.0f} GB while it is baked, and this "
                          "machine has {:.0f} GB; make it smaller",
                          options.texture_size, bytes / kGigabyte, machine / kGigabyte));
}

}  // namespace dapple
