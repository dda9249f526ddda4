#include "render/motion_lookup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "dapple/error.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {
namespace {

constexpr std::uint32_t kNoInstance = 0xffffffffu;  ///< DAPPLE_WORLD of the kernels

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorKind::input,
              fmt::format("motion vectors: {} (what is scaled to zero or loses its area is not in "
                          "a frame); without motion in --passes, frames can be rendered",
                          what));
}

/// Names tell which placement became which: two meshes may be alike.
void check_same_objects(const std::vector<std::string>& now, const std::vector<std::string>& next) {
  const auto missing = [](const auto& names, const auto& others) {
    return std::find_if(names.begin(), names.end(), [&](const std::string& name) {
      return std::find(others.begin(), others.end(), name) == others.end();
    });
  };
  if (now == next) return;
  if (const auto gone = missing(now, next); gone != now.end())
    refuse(fmt::format("object '{}' is not in the next frame", *gone));
  if (const auto added = missing(next, now); added != next.end())
    refuse(fmt::format("object '{}' is in the next frame only", *added));
  refuse("objects have another order in the next frame");
}

void check_same_topology(const Scene& now, const Scene& next) {
  check_same_objects(now.objects, next.objects);
  const bool same_meshes = std::equal(now.meshes.begin(), now.meshes.end(), next.meshes.begin(),
                                      next.meshes.end(), [](const Mesh& a, const Mesh& b) {
                                        return a.indices == b.indices &&
                                               a.positions.size() == b.positions.size() &&
                                               a.objects == b.objects;
                                      });
  const bool same_instances = std::equal(
      now.instances.begin(), now.instances.end(), next.instances.begin(), next.instances.end(),
      [](const Instance& a, const Instance& b) { return a.mesh == b.mesh; });
  if (same_meshes && same_instances) return;
  refuse("meshes or instances come or go until the next frame");
}

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
      triangles_(8 * bvh.blocks.size()),
      segments_(8 * bvh.segments.size()),
      project_now_(view),
      project_next_(next_.view) {
  check_same_topology(now_, next_.scene);
  for (std::uint32_t m = 0; m < now_.meshes.size(); ++m) {
    const Mesh& mesh = now_.meshes[m];
    deforms_.push_back(mesh.positions != next_.scene.meshes[m].positions);
    const ObjectOffsets &first = bvh.objects[m], &end = bvh.objects[m + 1];
    MeshPrimitive* lanes = mesh.has_strands() ? segments_.data() + 8 * std::size_t{first.segments}
                                              : triangles_.data() + 8 * std::size_t{first.block};
    for (std::size_t lane = first.lane(); lane < end.lane(); ++lane)
      *lanes++ = {m, bvh.primitives[lane]};
  }
  for (const InstanceRecord& record : bvh.instances) {
    const M44f &from = now_.instances[record.source].to_world,
               &to = next_.scene.instances[record.source].to_world;
    movements_.push_back({Imath::M44d(from).inverse(), Imath::M44d(to), from == to});
  }
}

V3d MotionLookup::shift_in_object(const MeshPrimitive& of, const V3d& at_object) const {
  V3d shift(0.0);
  if (!deforms_[of.mesh]) return shift;
  const Mesh &mesh = now_.meshes[of.mesh], &moved = next_.scene.meshes[of.mesh];
  const auto add = [&](std::uint32_t vertex, double weight) {
    shift += (V3d(moved.positions[vertex]) - V3d(mesh.positions[vertex])) * weight;
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
  const MeshPrimitive& of =
      is_segment ? segments_[primitive & ~DAPPLE_SEGMENTS] : triangles_[primitive];
  const Movement& movement = movements_[instance == kNoInstance ? 0 : instance];
  const V3d from(position);
  V3d to = from;
  if (!movement.still || deforms_[of.mesh]) {
    const V3d at_object = from * movement.now_to_object;
    to = (at_object + shift_in_object(of, at_object)) * movement.next_to_world;
  }
  const auto before = project_now_(from), after = project_next_(to);
  if (!before || !after) return {0, 0};
  return {after->x - before->x, before->y - after->y};
}

}  // namespace dapple
