#include "render/queries/point_checks.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "dapple/error.hpp"
#include "scene/check/finite.hpp"

namespace dapple {
namespace {

constexpr float kUnitTolerance = 1e-3f;

bool is_unit(const V3f& v) { return std::fabs(v.length() - 1) < kUnitTolerance; }

}  // namespace

void check_points(const char* query, std::span<const V3f> points, std::span<const V3f> normals) {
  if (points.size() != normals.size())
    throw Error(ErrorKind::usage,
                fmt::format("{}: {} points but {} normals", query, points.size(), normals.size()));
  const std::size_t wrong = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, points.size(), 4096), points.size(),
      [&](const tbb::blocked_range<std::size_t>& range, std::size_t first) {
        for (std::size_t i = range.begin(); i < range.end() && i < first; ++i)
          if (!is_finite(points[i]) || !is_unit(normals[i])) return i;
        return first;
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (wrong == points.size()) return;
  const V3f& point = points[wrong];
  if (!is_finite(point))
    throw Error(ErrorKind::usage, fmt::format("{}: point {} has a coordinate that is not finite: "
                                              "({}, {}, {})",
                                              query, wrong, point.x, point.y, point.z));
  const V3f& normal = normals[wrong];
  throw Error(ErrorKind::usage,
              fmt::format("{}: the normal of point {} is not a unit vector: ({}, {}, {})", query,
                          wrong, normal.x, normal.y, normal.z));
}

}  // namespace dapple
