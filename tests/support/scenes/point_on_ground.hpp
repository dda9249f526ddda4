// The scene in which lights are compared with closed forms: one pixel sees one point of a ground
// that faces +Y. In: the ground's lights and occluders; out: one value per channel of the film.
#pragma once

#include <gtest/gtest.h>

#include "support/scenes/scene_on_device.hpp"

namespace dapple::point_on_ground_test {

using namespace scene_test;

// A ground at y = 0, and a camera whose only pixel sees 0.1 mm of it around the origin.
inline Scene point_on_ground() {
  Scene scene;
  scene.materials.push_back(material_of(1));
  place(scene, square_mesh(20, 0, 1, 0));
  Camera camera = look_at({0, 1, 0}, {0, 0, 0}, {0, 0, -1}, 1);
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = 5e-5f;
  scene.cameras.push_back(camera);
  return scene;
}

// 4096 stratified rays from that point. For a smooth integrand their error is about log(n) / n of
// its variation, some 1e-3; the error of independent random rays would be about 1 %.
inline RenderOptions one_pixel(Estimator estimator = Estimator::exact, float footprint = 1) {
  RenderOptions options;
  options.width = options.height = options.spp = 1;
  options.light_rays = options.ao_rays = 4096;
  options.estimator = estimator;
  options.footprint = footprint;
  return options;
}
inline constexpr double kSampling = 2e-3;

inline float value(const Film& film, const std::string& channel) {
  const Plane* plane = film.find(channel);
  EXPECT_NE(plane, nullptr) << channel;
  return plane ? plane->pixels.at(0) : -1.0f;
}

}  // namespace dapple::point_on_ground_test
