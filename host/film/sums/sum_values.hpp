// Reads the sums of a picture as numbers. In: planes of fixed point, as FilmLayout orders them.
// Out: doubles.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "film/sums/film_sums.hpp"
#include "film/traced_picture.hpp"

namespace dapple {

/// The picture's fixed-point sums, by plane and pixel, as doubles.
class Sums {
 public:
  Sums(std::span<const std::int64_t> sums, std::uint32_t pixels) : sums_(sums), pixels_(pixels) {}
  [[nodiscard]] double at(std::uint32_t plane, std::uint32_t pixel) const {
    return static_cast<double>(sums_[std::size_t{plane} * pixels_ + pixel]);
  }
  [[nodiscard]] double total(std::uint32_t plane) const {
    double sum = 0;
    for (std::uint32_t p = 0; p < pixels_; ++p) sum += at(plane, p);
    return sum;
  }

 private:
  std::span<const std::int64_t> sums_;
  std::uint32_t pixels_;
};

/// The number that a pixel's sums are divided by. Without samples the sums are 0 and this is 1: the
/// pixel looks as if all its rays missed.
inline double sample_count(const TracedPicture& picture, std::uint32_t pixel) {
  return std::max(1u, picture.samples[pixel]);
}

/// The same for the sums of backs.
inline double back_sample_count(const Sums& sums, const FilmLayout& layout, std::uint32_t pixel) {
  return std::max(1.0, sums.at(layout.back_samples, pixel));
}

}  // namespace dapple
