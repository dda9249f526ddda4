#include "render/motion_lookup.hpp"

#include <algorithm>
#include <array>

#include "dapple/shared/bvh_node.h"
#include "dapple/shared/ray.h"

namespace dapple {
namespace {

/// Barycentric weights of the point of the triangle's plane that is closest to `p`.
std::array<double, 3> weights_on_triangle(const V3d& a, const V3d& b, const V3d& c, const V3d& p) {
  const V3d edge1 = b - a, edge2 = c - a, from = p - a, normal = edge1.cross(edge2);
  const double square = normal.length2();
  if (!(square > 0)) return {1, 0, 0};
  const double u = from.cross(edge2).dot(normal) / square;
  const double v = edge1.cross(from).dot(normal) / square;
  return {1 - u - v, u, v};
}

std::array<double, 2> weights_on_segment(const V3d& a, const V3d& b, const V3d& p) {
  const V3d axis = b - a;
  const double square = axis.length2();
  const double along = square > 0 ? std::clamp((p - a).dot(axis) / square, 0.0, 1.0) : 0.0;
  return {1 - along, along};
}

}  // namespace

MotionLookup::MotionLookup(const Scene& now, const View& view, const SceneBvh& bvh, FrameScene next)
    : now_(now),
      next_(std::move(next)),
      match_(now_, next_.scene),
      triangles_(8 * bvh.blocks.size()),
      segments_(8 * bvh.segments.size()),
      project_now_(view),
      project_next_(next_.view),
      camera_stands_(project_now_ == project_next_) {
  std::vector<std::uint32_t> part_of;  // by primitive of a mesh
  std::uint32_t part = 0;
  for (std::uint32_t m = 0; m < now_.meshes.size(); ++m) {
    const Mesh& mesh = now_.meshes[m];
    part_of.clear();
    for (; part < match_.parts.size() && match_.parts[part].mesh == m; ++part)
      part_of.insert(part_of.end(), match_.parts[part].count, part);
    const ObjectOffsets &first = bvh.objects[m], &end = bvh.objects[m + 1];
    PartPrimitive* lanes = mesh.has_strands() ? segments_.data() + 8 * std::size_t{first.segments}
                                              : triangles_.data() + 8 * std::size_t{first.block};
    for (std::size_t lane = first.lane(); lane < end.lane(); ++lane, ++lanes) {
      const std::uint32_t primitive = bvh.primitives[lane];
      // Files of the cache may name any; they are no primitives of the mesh then.
      if (primitive < part_of.size()) *lanes = {part_of[primitive], primitive};
    }
  }
  for (const InstanceRecord& record : bvh.instances) {
    const int counterpart = match_.instances[record.source];
    const M44f& from = now_.instances[record.source].to_world;
    const M44f& to = counterpart < 0
                         ? from
                         : next_.scene.instances[static_cast<std::size_t>(counterpart)].to_world;
    movements_.push_back(
        {Imath::M44d(from).inverse(), Imath::M44d(to), from == to, counterpart >= 0});
  }
}

V3d MotionLookup::shift_in_object(const PartPrimitive& of, const V3d& at_object) const {
  V3d shift(0.0);
  const MatchedPart& part = match_.parts[of.part];
  if (!part.deforms) return shift;
  const Mesh &mesh = now_.meshes[part.mesh], &moved = next_.scene.meshes[part.next_mesh];
  const auto add = [&](std::uint32_t vertex, double weight) {
    const auto next = static_cast<std::size_t>(std::int64_t{vertex} + part.vertex_shift);
    shift += (V3d(moved.positions[next]) - V3d(mesh.positions[vertex])) * weight;
  };
  const auto position = [&](std::uint32_t vertex) { return V3d(mesh.positions[vertex]); };
  if (mesh.has_strands()) {
    const std::uint32_t* ends = &mesh.indices[2 * std::size_t{of.primitive}];
    const auto weights = weights_on_segment(position(ends[0]), position(ends[1]), at_object);
    for (std::size_t i = 0; i < 2; ++i) add(ends[i], weights[i]);
  } else {
    const std::uint32_t* corners = &mesh.indices[3 * std::size_t{of.primitive}];
    const auto weights = weights_on_triangle(position(corners[0]), position(corners[1]),
                                             position(corners[2]), at_object);
    for (std::size_t i = 0; i < 3; ++i) add(corners[i], weights[i]);
  }
  return shift;
}

Imath::V2d MotionLookup::at(std::uint32_t instance, std::uint32_t primitive,
                            const V3f& position) const {
  const bool is_segment = (primitive & DAPPLE_SEGMENTS) != 0;
  const PartPrimitive& of =
      is_segment ? segments_[primitive & ~DAPPLE_SEGMENTS] : triangles_[primitive];
  const MatchedPart& part = match_.parts[of.part];
  const Movement& movement = movements_[instance == DAPPLE_WORLD ? 0 : instance];
  const V3d from(position);
  V3d to = from;
  const bool moves = part.is_there && movement.is_there && (!movement.still || part.deforms);
  if (!moves && camera_stands_) return {0, 0};
  if (moves) {
    const V3d at_object = from * movement.now_to_object;
    to = (at_object + shift_in_object(of, at_object)) * movement.next_to_world;
  }
  const auto before = project_now_(from), after = project_next_(to);
  if (!before || !after) return {0, 0};
  return {after->x - before->x, before->y - after->y};
}

}  // namespace dapple
