#include "scene/images/dome_rows.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dapple/error.hpp"
#include "scene/check/finite.hpp"
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

/// The part of pixel `i` that lies in box `box`, where `boxes` of equal width cover `pixels`.
double part_in_box(std::uint64_t i, std::uint64_t box, std::uint64_t boxes, std::uint64_t pixels) {
  // Coordinates in parts of a pixel, of which there are as many as boxes.
  const std::uint64_t begin = std::max(box * pixels, i * boxes);
  const std::uint64_t end = std::min((box + 1) * pixels, (i + 1) * boxes);
  return end - begin == boxes ? 1 : static_cast<double>(end - begin) / static_cast<double>(boxes);
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

std::uint32_t DomeRows::first_row(std::uint32_t row) const {
  return static_cast<std::uint32_t>(std::uint64_t{row} * height_ / result_.height);
}

std::uint32_t DomeRows::end_row(std::uint32_t row) const {
  return static_cast<std::uint32_t>((std::uint64_t{row} * height_ + result_.height - 1) /
                                    result_.height);
}

/// A row of means over boxes of equal width and height, weighted by solid angle. `pixels`: from
/// first_row() on.
void DomeRows::average(std::uint32_t row, const V3f* pixels) {
  std::vector<V3d> sums(result_.width, V3d(0.0));
  std::vector<double> weights(result_.width, 0.0);
  const std::uint32_t first = first_row(row);
  for (std::uint32_t y = first; y < end_row(row + 1); ++y) {
    const double weight =
        texel_solid_angle(width_, height_, y) * part_in_box(y, row, result_.height, height_);
    const V3f* pixel = pixels + std::size_t{y - first} * width_;
    for (std::uint32_t at = 0; at < result_.width; ++at) {
      const std::uint64_t begin = std::uint64_t{at} * width_, end = begin + width_;
      for (std::uint64_t x = begin / result_.width; x * result_.width < end; ++x) {
        const double part = weight * part_in_box(x, at, result_.width, width_);
        sums[at] += V3d(not_negative(pixel[x])) * part;
        weights[at] += part;
      }
    }
  }
  for (std::uint32_t x = 0; x < result_.width; ++x)
    result_.radiance[std::size_t{row} * result_.width + x] = V3f(sums[x] / weights[x]);
}

std::vector<DomeRows::Strip> DomeRows::strips(std::uint32_t rows) const {
  const std::uint32_t step = std::max(1u, rows / down_);
  std::vector<Strip> all;
  for (std::uint32_t row = 0; row < result_.height; row += step) {
    const std::uint32_t end = std::min(row + step, result_.height), first = first_row(row);
    all.push_back({first, end_row(end) - first, row, end - row});
  }
  return all;
}

void DomeRows::add(const Strip& strip, std::span<const V3f> pixels) {
  const std::size_t first_pixel = std::size_t{strip.first} * width_;
  const std::size_t shared = std::size_t{end_row(strip.row) - strip.first} * width_;  // checked
  tbb::parallel_for(tbb::blocked_range<std::size_t>(shared, pixels.size(), kBlock),
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
  tbb::parallel_for(strip.row, strip.row + strip.rows, [&](std::uint32_t row) {
    average(row, pixels.data() + std::size_t{first_row(row) - strip.first} * width_);
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
