#include "scene/images/dome_rows.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dapple/error.hpp"
#include "scene/finite.hpp"
#include "scene/images/dome_image.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kMaxWidth = 2048, kMaxHeight = 1024;
constexpr std::size_t kBlock = 1u << 14;  ///< pixels that a task checks

bool is_allowed(const V3f& radiance) {
  return std::max({radiance.x, radiance.y, radiance.z}) <= kMaxRadiance && is_finite(radiance);
}

bool is_negative(const V3f& radiance) { return std::min({radiance.x, radiance.y, radiance.z}) < 0; }

V3f not_negative(const V3f& radiance) {
  return {std::max(radiance.x, 0.0f), std::max(radiance.y, 0.0f), std::max(radiance.z, 0.0f)};
}

std::string why_refused(const V3f& radiance) {
  for (int channel = 0; channel < 3; ++channel)
    if (!std::isfinite(radiance[channel])) return "not finite";
  const float largest = std::max({radiance.x, radiance.y, radiance.z});
  return fmt::format("{:.3g}, above {:g}", largest, kMaxRadiance);
}

}  // namespace

DomeRows::DomeRows(std::uint32_t width, std::uint32_t height)
    : width_(width),
      height_(height),
      across_((width + kMaxWidth - 1) / kMaxWidth),
      down_((height + kMaxHeight - 1) / kMaxHeight) {
  result_.width = std::max(1u, width / across_);
  result_.height = std::max(1u, height / down_);
  result_.radiance.resize(std::size_t{result_.width} * result_.height);
}

void DomeRows::check(std::size_t first_pixel, std::span<const V3f> pixels) {
  std::size_t negative = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!is_allowed(pixels[i])) {
      const std::lock_guard lock(refusal_);
      if (first_pixel + i < refused_) {
        refused_ = first_pixel + i;
        refused_radiance_ = pixels[i];
      }
      return;
    }
    negative += is_negative(pixels[i]);
  }
  negative_ += negative;
}

/// A row of means over boxes of equal width and of down_ rows, weighted by solid angle. Rows that
/// do not fill a box belong to the last one, at the nadir. `pixels`: from the first row of the
/// boxes on.
void DomeRows::average(std::uint32_t row, const V3f* pixels) {
  std::vector<V3d> sums(result_.width, V3d(0.0));
  std::vector<double> weights(result_.width, 0.0);
  const std::uint32_t first = row * down_;
  const std::uint32_t end = row + 1 == result_.height ? height_ : first + down_;
  for (std::uint32_t y = first; y < end; ++y) {
    const double weight = texel_solid_angle(width_, height_, y);
    const V3f* pixel = pixels + std::size_t{y - first} * width_;
    for (std::uint32_t at = 0; at < result_.width; ++at) {
      // Coordinates in parts of a pixel, of which there are as many as texels in a row.
      const std::uint64_t parts = result_.width, begin = std::uint64_t{at} * width_;
      const std::uint64_t box_end = begin + width_;
      for (std::uint64_t x = begin / parts; x * parts < box_end; ++x) {
        const std::uint64_t inside =
            std::min(box_end, (x + 1) * parts) - std::max(begin, x * parts);
        const double part = inside == parts
                                ? weight
                                : weight * static_cast<double>(inside) / static_cast<double>(parts);
        sums[at] += V3d(not_negative(pixel[x])) * part;
        weights[at] += part;
      }
    }
  }
  for (std::uint32_t x = 0; x < result_.width; ++x)
    result_.radiance[std::size_t{row} * result_.width + x] = V3f(sums[x] / weights[x]);
}

std::vector<DomeRows::Strip> DomeRows::strips(std::uint32_t rows) const {
  const std::uint32_t step = down_ * std::max(1u, rows / down_);
  std::vector<Strip> all;
  for (std::uint32_t first = 0; first + step <= height_; first += step)
    all.push_back({first, step});
  if (all.empty()) all.push_back({0, 0});
  all.back().count = height_ - all.back().first;
  return all;
}

void DomeRows::add(const Strip& strip, std::span<const V3f> pixels) {
  const std::size_t first_pixel = std::size_t{strip.first} * width_;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels.size(), kBlock),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      check(first_pixel + range.begin(),
                            pixels.subspan(range.begin(), range.size()));
                    });
  if (!is_scaled()) {
    std::transform(pixels.begin(), pixels.end(),
                   result_.radiance.begin() + static_cast<std::ptrdiff_t>(first_pixel),
                   not_negative);
    return;
  }
  const std::uint32_t begin = strip.first / down_;
  const std::uint32_t end =
      strip.first + strip.count == height_ ? result_.height : begin + strip.count / down_;
  tbb::parallel_for(begin, end, [&](std::uint32_t row) {
    average(row, pixels.data() + std::size_t{row - begin} * down_ * width_);
  });
}

Environment DomeRows::take(const std::string& path) {
  if (refused_ < std::numeric_limits<std::size_t>::max()) {
    throw Error(ErrorKind::input, fmt::format("{}: pixel {}, {} is {}", path, refused_ % width_,
                                              refused_ / width_, why_refused(refused_radiance_)));
  }
  result_.negative_pixels = negative_;
  return std::move(result_);
}

}  // namespace dapple
