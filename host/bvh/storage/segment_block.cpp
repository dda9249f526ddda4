#include "bvh/storage/segment_block.hpp"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

/// Returns the exponent of the smallest step, a power of two and at least 2^-126, such that `size`
/// is at most 65534 steps. One more step is reserved: the origin is rounded down to a whole step.
int step_power(float size) {
  int power = -126;
  if (size > 0.0f) {
    power = static_cast<int>(std::ceil(std::log2(double{size} / (DAPPLE_MAX_GRID_CODE - 1))));
  }
  return std::clamp(power, -126, 127);
}

/// Chooses the grid of a block around its end points. Origins are whole steps, so that neighbouring
/// blocks with the same step share a grid.
void set_grid(SegmentBlock& block, const Box3f& points) {
  const V3f size = points.size();
  const int power = step_power(std::max({size.x, size.y, size.z}));
  block.exponent = static_cast<uchar>(power + 127);
  const double step = std::ldexp(1.0, power);
  for (int axis = 0; axis < 3; ++axis) {
    const double wanted = std::floor(points.min[axis] / step) * step;
    auto origin = static_cast<float>(wanted);
    if (origin > points.min[axis]) origin = points.min[axis];
    block.origin[axis] = origin;
  }
}

ushort grid_code(const SegmentBlock& block, float coordinate, int axis) {
  const double steps = (double{coordinate} - block.origin[axis]) / segment_step(&block);
  return static_cast<ushort>(std::clamp(std::round(steps), 0.0, double{DAPPLE_MAX_GRID_CODE}));
}

void set_plane(schar (&codes)[3][8], unsigned lane, const V3f& normal) {
  const float largest = std::max({std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)});
  const float scale = largest > 0.0f ? DAPPLE_MAX_PLANE_CODE / largest : 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    codes[axis][lane] = static_cast<schar>(std::lround(normal[axis] * scale));
  }
}

/// The 8-bit code of a radius or an opacity. That of a positive value is at least 1: it must not
/// vanish beside a much greater one.
uchar code_of(float value, float greatest) {
  if (!(value > 0.0f && greatest > 0.0f)) return 0;
  return static_cast<uchar>(std::max(1l, std::lround(255.0f * std::sqrt(value / greatest))));
}

/// Gives a segment that is shorter than a step of the grid the length of one, along its longest
/// side: kernels divide by it.
void lengthen(SegmentBlock& block, unsigned lane, const V3f& axis) {
  const V3f sides(std::fabs(axis.x), std::fabs(axis.y), std::fabs(axis.z));
  const int k = sides.x >= std::max(sides.y, sides.z) ? 0 : sides.y >= sides.z ? 1 : 2;
  const bool up =
      axis[k] >= 0 ? block.begin[k][lane] < DAPPLE_MAX_GRID_CODE : block.begin[k][lane] == 0;
  block.end[k][lane] = static_cast<ushort>(block.begin[k][lane] + (up ? 1 : -1));
}

void set_lane(SegmentBlock& block, unsigned lane, const StrandSegment& segment) {
  bool has_length = false;
  for (int axis = 0; axis < 3; ++axis) {
    block.begin[axis][lane] = grid_code(block, segment.point[0][axis], axis);
    block.end[axis][lane] = grid_code(block, segment.point[1][axis], axis);
    has_length |= block.begin[axis][lane] != block.end[axis][lane];
  }
  if (!has_length) lengthen(block, lane, segment.point[1] - segment.point[0]);
  set_plane(block.begin_plane, lane, segment.plane[0]);
  set_plane(block.end_plane, lane, segment.plane[1]);
  block.begin_radius[lane] = code_of(segment.radius[0], block.radius);
  block.end_radius[lane] = code_of(segment.radius[1], block.radius);
  block.opacity_code[lane] = code_of(segment.opacity, block.opacity);
  block.begin_caps = static_cast<uchar>(block.begin_caps | unsigned{segment.cap[0]} << lane);
  block.end_caps = static_cast<uchar>(block.end_caps | unsigned{segment.cap[1]} << lane);
}

}  // namespace

SegmentBlock pack_segments(std::span<const StrandSegment> segments) {
  SegmentBlock block{};
  Box3f points;
  for (const StrandSegment& segment : segments) {
    for (int end = 0; end < 2; ++end) {
      points.extendBy(segment.point[end]);
      block.radius = std::max(block.radius, segment.radius[end]);
    }
    block.opacity = std::max(block.opacity, segment.opacity);
  }
  set_grid(block, points);
  for (unsigned lane = 0; lane < segments.size(); ++lane) set_lane(block, lane, segments[lane]);
  return block;
}

StrandSegment unpack_segment(const SegmentBlock& block, unsigned lane) {
  const auto point = [&](const ushort(&codes)[3][8]) {
    V3f p;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = block.origin[axis] + static_cast<float>(codes[axis][lane]) * segment_step(&block);
    }
    return p;
  };
  const auto plane = [&](const schar(&codes)[3][8]) {
    return V3f(codes[0][lane], codes[1][lane], codes[2][lane]);
  };
  StrandSegment segment;
  segment.point = {point(block.begin), point(block.end)};
  segment.plane = {plane(block.begin_plane), plane(block.end_plane)};
  const float radius = segment_radius_step(&block);
  segment.radius = {segment_radius(block.begin_radius[lane], radius),
                    segment_radius(block.end_radius[lane], radius)};
  segment.cap = {(block.begin_caps >> lane & 1) != 0, (block.end_caps >> lane & 1) != 0};
  segment.opacity = segment_opacity_of(&block, lane);
  return segment;
}

}  // namespace dapple
