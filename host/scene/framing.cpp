// Cameras for scenes without their own. In: a scene's bounds, or two points; out: a camera.
#include <Imath/ImathBoxAlgo.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/check/finite.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/checked_bounds.hpp"

namespace dapple {
namespace {

constexpr float kFrameMargin = 1.1f;      // width of the frame over width of the scene
constexpr float kFrameElevation = 0.21f;  // tangent of the camera's elevation, 12 degrees
constexpr float kElongation = 2;          // depth over width of a scene that is seen from its side

V3f row(const M44f& m, int i) { return {m[i][0], m[i][1], m[i][2]}; }

M44f from_rows(V3f x, V3f y, V3f z, V3f origin) {
  return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, origin.x, origin.y, origin.z, 1};
}

Box3f bounds_or_unit_box(const Scene& scene, const M44f& transform = {}) {
  const Box3f bounds = checked_bounds(scene, transform);
  return bounds.isEmpty() ? Imath::transform(Box3f({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}), transform)
                          : bounds;
}

/// Two directions of a picture: a camera sees p between two planes if |across . (p - camera)| <=
/// tangent * back . (camera - p). Points are relative to the middle of the scene.
struct Axis {
  V3f across, back, middle;
};

/// The largest values over the scene of across . p + tangent * back . p, of the same with -across,
/// and of back . p: where the planes touch the scene.
struct Touch {
  float right = 0, left = 0, front = 0, depth = 0;
  Touch(const Scene& scene, const Axis& axis, float tangent) {
    const V3f a = axis.across + tangent * axis.back, b = -axis.across + tangent * axis.back;
    const M44f functions(a.x, b.x, axis.back.x, 0, a.y, b.y, axis.back.y, 0,  //
                         a.z, b.z, axis.back.z, 0,                            //
                         -a.dot(axis.middle), -b.dot(axis.middle), -axis.back.dot(axis.middle), 1);
    const Box3f box = bounds_or_unit_box(scene, functions);
    right = box.max.x;
    left = box.max.y;
    front = box.max.z;
    depth = box.size().z;
  }
};

/// How far back a camera must at least be.
float least_distance(const Touch& touch, float tangent) {
  // The camera is in front of everything, also where the scene is a line along its view or a point.
  const float closest = touch.front + (touch.depth > 0 ? 0.1f * touch.depth : 1);
  return std::max((touch.right + touch.left) / (2 * tangent), closest);
}

/// Where a camera at `distance` along `back` is along `across` so that the picture has equal
/// margins: planes of a smaller tangent touch the scene on both sides. `touch`: at `tangent`.
float centred(const Scene& scene, const Axis& axis, Touch touch, float tangent, float distance) {
  constexpr int kSteps = 2;                                         // each visits all vertices
  const float enough = 2e-3f * tangent * (distance - touch.front);  // a part of the frame
  const auto slack = [&](const Touch& at, float of) {
    return 2 * of * distance - at.right - at.left;
  };
  // The slack is concave in the tangent, negative at 0, and 0 or more at `tangent`: chords from 0
  // never pass the tangent that is sought.
  float none = 0, wide = tangent;
  for (int step = 0; step < kSteps; ++step) {
    const float has = slack(touch, wide);
    if (!(has > enough)) break;
    if (step == 0) none = slack(Touch(scene, axis, 0), 0);
    if (!(none < 0)) break;
    wide *= none / (none - has);
    touch = Touch(scene, axis, wide);
  }
  return (touch.right - touch.left) / 2;
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
  const V3f back((Imath::V3d(from) - Imath::V3d(at)).normalized());
  if (back.length2() == 0) throw Error(ErrorKind::usage, "camera: from and at are the same point");
  const V3f across = V3f(Imath::V3d(up).normalized()).cross(back);
  if (across.length() < 1e-5f) {
    throw Error(ErrorKind::usage, "camera: up is zero or points along the view; choose another");
  }
  const V3f right = across.normalized();
  Camera camera;
  camera.to_world = from_rows(right, back.cross(right), back, from);
  camera.fov_y = fov_y;
  return camera;
}

Camera frame_scene(const Scene& scene, float aspect, float fov_y) {
  require_field_of_view(fov_y);
  if (!(aspect > 0) || !std::isfinite(aspect))
    throw Error(ErrorKind::usage, "camera: the aspect ratio must be above 0, and finite");
  check_geometry(scene);
  const Box3f bounds = bounds_or_unit_box(scene);
  const V3f size = bounds.size();
  const V3f front = size.z > kElongation * size.x ? V3f(1, 0, 0) : V3f(0, 0, 1);
  Camera camera = look_at(front + V3f(0, kFrameElevation, 0), {0, 0, 0}, {0, 1, 0}, fov_y);
  const float tangent = std::tan(fov_y / 2) / kFrameMargin;
  const V3f right = row(camera.to_world, 0), up = row(camera.to_world, 1),
            back = row(camera.to_world, 2);
  const Axis horizontal{right, back, bounds.center()}, vertical{up, back, bounds.center()};
  const float wide = tangent * aspect;
  const Touch sides(scene, horizontal, wide), ends(scene, vertical, tangent);
  const float distance = std::max(least_distance(sides, wide), least_distance(ends, tangent));
  const V3f from = bounds.center() + right * centred(scene, horizontal, sides, wide, distance) +
                   up * centred(scene, vertical, ends, tangent, distance) + back * distance;
  for (int k = 0; k < 3; ++k) camera.to_world[3][k] = from[k];
  camera.name = "frame";
  return camera;
}

}  // namespace dapple
