// Cameras for scenes without their own. In: a scene's bounds, or two points; out: a camera.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"

namespace dapple {
namespace {

constexpr float kFrameMargin = 1.06f;     // width of the frame over width of the scene
constexpr float kFrameElevation = 0.21f;  // tangent of the camera's elevation, 12 degrees
constexpr float kElongation = 2;          // depth over width of a scene that is seen from its side

bool is_finite(V3f v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

V3f row(const M44f& m, int i) { return {m[i][0], m[i][1], m[i][2]}; }

M44f from_rows(V3f x, V3f y, V3f z, V3f origin) {
  return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, origin.x, origin.y, origin.z, 1};
}

V3f corner(const Box3f& box, int i) {
  return {(i & 1 ? box.max : box.min).x, (i & 2 ? box.max : box.min).y,
          (i & 4 ? box.max : box.min).z};
}

// The smallest distance from the box's centre, along the Z axis of `axes`, at which the camera
// sees every corner.
float framing_distance(const Box3f& box, const M44f& axes, float tan_x, float tan_y) {
  float distance = 0;
  for (int i = 0; i < 8; ++i) {
    const V3f p = corner(box, i) - box.center();
    const float across =
        std::max(std::abs(p.dot(row(axes, 0))) / tan_x, std::abs(p.dot(row(axes, 1))) / tan_y);
    distance = std::max(distance, p.dot(row(axes, 2)) + kFrameMargin * across);
  }
  return distance > 0 ? distance : 1;  // 0: all of the scene is one point
}

Box3f bounds_or_unit_box(const Scene& scene) {
  const Box3f bounds = scene_bounds(scene);
  return bounds.isEmpty() ? Box3f({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}) : bounds;
}

void require_field_of_view(float fov_y) {
  if (!(fov_y > 0 && fov_y < std::numbers::pi_v<float>)) {
    throw Error(ErrorKind::usage, "camera: the field of view is " +
                                      std::to_string(fov_y * 180 / std::numbers::pi_v<float>) +
                                      " degrees and must be between 0 and 180");
  }
}

}  // namespace

Camera look_at(V3f from, V3f at, V3f up, float fov_y) {
  require_field_of_view(fov_y);
  if (!is_finite(from) || !is_finite(at) || !is_finite(up)) {
    throw Error(ErrorKind::usage, "camera: from, at and up must be finite");
  }
  const V3f back = (from - at).normalized();
  if (back.length2() == 0) throw Error(ErrorKind::usage, "camera: from and at are the same point");
  const V3f across = up.normalized().cross(back);
  if (across.length() < 1e-5f) {
    throw Error(ErrorKind::usage, "camera: up is zero or points along the view");
  }
  const V3f right = across.normalized();
  Camera camera;
  camera.to_world = from_rows(right, back.cross(right), back, from);
  camera.fov_y = fov_y;
  return camera;
}

Camera frame_scene(const Scene& scene, float aspect, float fov_y) {
  require_field_of_view(fov_y);
  assert(aspect > 0);
  const Box3f bounds = bounds_or_unit_box(scene);
  const V3f size = bounds.size();
  const V3f front = size.z > kElongation * size.x ? V3f(1, 0, 0) : V3f(0, 0, 1);
  Camera camera = look_at(front + V3f(0, kFrameElevation, 0), {0, 0, 0}, {0, 1, 0}, fov_y);
  const float tan_y = std::tan(fov_y / 2);
  const float distance = framing_distance(bounds, camera.to_world, tan_y * aspect, tan_y);
  const V3f from = bounds.center() + row(camera.to_world, 2) * distance;
  for (int k = 0; k < 3; ++k) camera.to_world[3][k] = from[k];
  camera.name = "frame";
  return camera;
}

}  // namespace dapple
