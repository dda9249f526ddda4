// Lights for scenes without their own. In: the camera, and for the key light the scene's bounds.
// Out: a sun and a sky, or one rect light (a photographer's "key light").
#include "scene/lights/default_lights.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "dapple/scene.hpp"
#include "scene/lights/rect_axes.hpp"

namespace dapple {
namespace {

constexpr float kKeyDistance = 3;  // scene radii from the centre

/// Irradiance of a surface that faces the sun. A surface that faces up gets a fifth of that from
/// the sky, as on a clear day.
const V3f kSunIrradiance(3.1f, 2.9f, 2.55f);
/// Wider than the real sun, as through thin cloud: shadows soften with distance.
constexpr float kSunDegrees = 1.5f;

constexpr std::uint32_t kSkyRows = 128;  ///< from the zenith to the nadir
const V3f kZenith(0.1f, 0.18f, 0.36f), kHorizon(0.32f, 0.38f, 0.45f), kBelow(0.1f, 0.095f, 0.085f);

/// A unit vector up, left and in front of the camera. Up is the world's +Y, so that the light stays
/// above the ground when the camera looks down or up.
V3f above_left_in_front(const Camera& camera) {
  const M44f& axes = camera.to_world;
  const V3f right(axes[0][0], axes[0][1], axes[0][2]);
  V3f back(axes[2][0], 0, axes[2][2]);
  // One that looks straight down or up has its upper side in front of it or behind it.
  constexpr float kVertical = 1e-3f;
  if (back.length() < kVertical) back = V3f(axes[1][0], 0, axes[1][2]) * (axes[2][1] > 0 ? -1 : 1);
  return (V3f(0, 0.8f, 0) - right * 0.6f + back.normalized() * 0.6f).normalized();
}

/// Radiance of the sky where the sine of the elevation is `height`: the zenith's blue gives way to
/// the pale horizon; below the horizon there is the light that a ground returns.
V3f sky_radiance(float height) {
  if (height < 0) return kBelow;
  const float near_horizon = (1 - height) * (1 - height) * (1 - height);
  return kZenith * (1 - near_horizon) + kHorizon * near_horizon;
}

std::shared_ptr<const Environment> sky_image() {
  auto image = std::make_shared<Environment>();
  image->width = 1;
  image->height = kSkyRows;
  for (std::uint32_t row = 0; row < kSkyRows; ++row) {
    const float angle = (static_cast<float>(row) + 0.5f) * std::numbers::pi_v<float> / kSkyRows;
    image->radiance.push_back(sky_radiance(std::cos(angle)));
  }
  return image;
}

}  // namespace

std::vector<Light> daylight(const Camera& camera) {
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = -above_left_in_front(camera);
  sun.angular_radius = kSunDegrees * std::numbers::pi_v<float> / 360;
  const float sine = std::sin(sun.angular_radius);
  sun.radiance = kSunIrradiance / (std::numbers::pi_v<float> * sine * sine);
  Light sky;
  sky.name = "sky";
  sky.kind = LightKind::dome;
  sky.environment = sky_image();
  return {sun, sky};
}

Light key_light(const Scene& scene, const Camera& camera) {
  const Box3f scene_box = scene_bounds(scene);
  const Box3f bounds = scene_box.isEmpty() ? Box3f({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}) : scene_box;
  const float radius = std::max(bounds.size().length() / 2, 1e-3f);
  const V3f toward_light = above_left_in_front(camera);
  Light light;
  light.name = "key";
  light.kind = LightKind::rect;
  light.position = bounds.center() + toward_light * (kKeyDistance * radius);
  light.direction = -toward_light;
  const RectAxes axes = rect_axes(light.direction);
  light.edge_u = axes.u * radius;
  light.edge_v = axes.v * radius;
  // Irradiance at the centre is radiance * area / distance^2 to first order, which is about 1.
  light.radiance = V3f(kKeyDistance * kKeyDistance);
  return light;
}

std::string default_light_note(bool on_ground) {
  std::string note =
      "no lights in the scene: added lights named sun and sky; --lights F brings others";
  if (!on_ground) note += ", --ground a floor for their shadows";
  return note;
}

}  // namespace dapple
