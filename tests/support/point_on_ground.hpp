// A point of a ground facing +Y, seen by one pixel: what closed forms of lights are tried at.
#pragma once

#include <gtest/gtest.h>

#include "support/scene_on_device.hpp"

namespace dapple::point_on_ground_test {

using namespace scene_test;

// A ground at y = 0, and a camera that sees 0.1 mm of it around the origin in one pixel.
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

// 4096 stratified rays from that point. Their error for a smooth integrand is of order
// log(n) / n of its variation, some 1e-3; plain random rays would have 1 % or so.
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
