// Facets of a coarse sphere: with shading normals, AO and sun are those of the round sphere; with
// geometric normals, the same limits are broken.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dapple/render.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/shading_pictures.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

using test::options_of;
using test::scene_of;
using test::small_sun;
using test::smooth_sphere;
using test::three;

/// Distances of a layer from a closed form, at pixels that the sphere covers.
struct Distances {
  double rmse = 0, worst = 0;
  int pixels = 0;
};

/// `closed_form` takes the normal of the round sphere at the middle of the pixel's samples.
template <class ClosedForm>
Distances distances_from(const ClosedForm& closed_form, const Film& film, const char* channel) {
  Distances result;
  for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
    if (film.find("A")->pixels[p] < 1) continue;
    const double there = closed_form(three(film, "P", p).normalized());
    const double distance = std::fabs(double{film.find(channel)->pixels[p]} - there);
    result.worst = std::max(result.worst, distance);
    result.rmse += distance * distance;
    ++result.pixels;
  }
  result.rmse = std::sqrt(result.rmse / result.pixels);
  return result;
}

// A convex surface occludes nothing of its own hemispheres, nor does a faceted one: facets only
// show at the wall below. A prefiltered ray may end in a node beside the surface: one of the 32 of
// a pixel.
TEST(ShadingNormal, ASphereOf504TrianglesIsUnoccludedEverywhere) {
  Scene scene = scene_of(smooth_sphere());
  EXPECT_EQ(scene.meshes[0].primitive_count(), 504u);
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    RenderOptions options = options_of(Normals::shading, estimator);
    options.light = false;
    const Film film = render(scene, options).film;
    const auto& ao = film.find("ao.R")->pixels;
    const double mean = std::accumulate(ao.begin(), ao.end(), 0.0) / static_cast<double>(ao.size());
    EXPECT_NEAR(mean, 1, estimator == Estimator::exact ? 1e-5 : 1e-4);
    EXPECT_GE(*std::min_element(ao.begin(), ao.end()),
              estimator == Estimator::exact ? 0.999f : 1 - 1.0f / 32);
  }
}

/// The sphere, and a wall behind the camera that takes half of the sphere of directions.
Scene sphere_and_wall() {
  Scene scene = scene_of(smooth_sphere());
  constexpr float kSide = 4000;
  Mesh wall;
  wall.positions = {{4, -kSide, -kSide}, {4, kSide, -kSide}, {4, kSide, kSide}, {4, -kSide, kSide}};
  wall.indices = {0, 1, 2, 0, 2, 3};
  wall.materials = {0, 0};
  scene.meshes.push_back(wall);
  scene.instances.resize(2);
  scene.instances[1].mesh = 1;
  return scene;
}

// An endless wall across +X hides (1 + n.x) / 2 of the hemisphere around n. This one ends 4 / 4000
// above its horizon, which is 0.0005 of AO at most.
TEST(ShadingNormal, ASphereAtAWallHasNoFacetsInItsAo) {
  const Scene scene = sphere_and_wall();
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    for (const Normals normals : {Normals::shading, Normals::geometric}) {
      RenderOptions options = options_of(normals, estimator);
      options.light = false;
      options.spp = 64;
      options.look->from = V3f(3, 1, 3);
      const Distances ao = distances_from([](const V3f& n) { return 0.5 - 0.5 * double{n.x}; },
                                          render(scene, options).film, "ao.R");
      EXPECT_GT(ao.pixels, 1000);
      // The noise of 128 rays, stratified: 0.0095, of independent ones up to 0.044. Normals of
      // facets are off by up to pi / 21 and pi / 26, uniformly, about 0.09 and 0.07 in root mean
      // square; half of the part along X adds 0.023 to the noise.
      if (normals == Normals::shading) {
        EXPECT_LE(ao.rmse, 0.012);
      } else {
        EXPECT_GT(ao.rmse, 1.8 * 0.012) << "facets have to show";
      }
    }
  }
}

/// The inside of a ring, which bends both ways, in the sun.
Film inside_of_ring(int around, int across) {
  Scene scene = test::smooth_torus(around, across);
  scene.lights = {small_sun(V3f(1, 1, 0).normalized())};
  RenderOptions options = options_of(Normals::shading);
  options.width = options.height = 120;
  options.look = LookAt{V3f(-0.3f, 3.4f, -1.1f), V3f(0, 0, 0), V3f(0, 0, -1)};
  options.fov_degrees = 22;
  options.spp = 64;
  return render(scene, options).film;
}

// The pixels that are much darker than those of a fine ring lie at its own shadows, by a few of
// 4,567. With points that stay on facets where the surface bends both ways they were 59.
TEST(ShadingNormal, FacetsOfASurfaceThatBendsBothWaysCastNoShadowsOnIt) {
  const Film fine = inside_of_ring(160, 80), coarse = inside_of_ring(14, 8);
  int lit = 0, dark = 0;
  for (std::size_t p = 0; p < fine.find("A")->pixels.size(); ++p) {
    if (fine.find("A")->pixels[p] < 1 || coarse.find("A")->pixels[p] < 1) continue;
    if ((three(fine, "N", p) - three(coarse, "N", p)).length() > 0.2f) continue;
    const float there = fine.find("light.sun.R")->pixels[p];
    if (there < 0.1f) continue;
    ++lit;
    dark += coarse.find("light.sun.R")->pixels[p] < 0.3f * there;
  }
  EXPECT_GT(lit, 4000);
  EXPECT_LE(dark, 20);
}

// The irradiance of a distant sun is the cosine, up to the terminator and behind it.
TEST(ShadingNormal, ASphereInTheSunIsAsBrightAsItsCosine) {
  Scene scene = scene_of(smooth_sphere());
  const V3f towards = V3f(1, 0.3f, 0.4f).normalized();
  scene.lights = {small_sun(towards)};
  const auto cosine = [&](const V3f& n) { return std::max(0.0, double{n.dot(towards)}); };
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const Film film = render(scene, options_of(Normals::shading, estimator)).film;
    ASSERT_NE(film.find("Ng.X"), nullptr);
    int lit = 0, dark = 0;
    for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
      if (film.find("A")->pixels[p] < 1) continue;
      // The middle of the pixel's samples lies on the facet; its direction is the sphere's normal.
      const V3f normal = three(film, "P", p).normalized();
      EXPECT_LE((three(film, "N", p).normalized() - normal).length(), 0.03f);
      lit += normal.dot(towards) > 0.03f;
      dark += normal.dot(towards) < -0.03f;
    }
    EXPECT_GT(lit, 300);
    EXPECT_GT(dark, 100);
    // The cosine changes by 0.04 and more across a pixel: on the terminator the mean of its lit
    // half is 0.005 and more where the middle has 0. The other pixels only have rounding.
    const Distances sun = distances_from(cosine, film, "light.sun.R");
    EXPECT_LE(sun.worst, 0.01);
    EXPECT_LE(sun.rmse, 0.0012);
    // Facets are off by 0.09 and 0.07 in root mean square, as above, in all directions alike.
    const Film faceted = render(scene, options_of(Normals::geometric, estimator)).film;
    const Distances of_facets = distances_from(cosine, faceted, "light.sun.R");
    EXPECT_GT(of_facets.worst, 10 * 0.01) << "facets have to show";
    EXPECT_GT(of_facets.rmse, 20 * 0.0012) << "facets have to show";
  }
}

// They may not be flat in other frames, whose files have the same layers.
TEST(ShadingNormal, HasALayerWhereASceneThatMovesIsFlatJustNow) {
  for (const bool moves : {false, true}) {
    Mesh flat = scene_test::square_mesh(1, 0, 1, 0);
    flat.normals.assign(flat.positions.size(), V3f(0, 1, 0));
    Scene scene = scene_of(std::move(flat));
    if (moves) scene.animations.emplace_back();
    EXPECT_EQ(render(scene, options_of(Normals::shading)).film.find("Ng.X") != nullptr, moves);
    EXPECT_EQ(render(scene, options_of(Normals::geometric)).film.find("Ng.X"), nullptr);
  }
}

TEST(ShadingNormal, FacetsAreThereWithGeometricNormals) {
  Scene scene = scene_of(smooth_sphere());
  scene.lights = {small_sun({1, 0.3f, 0.4f})};
  const Film film = render(scene, options_of(Normals::geometric)).film;
  EXPECT_EQ(film.find("Ng.X"), nullptr);
  double worst = 0;
  for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
    if (film.find("A")->pixels[p] < 1) continue;
    worst = std::max<double>(
        worst, (three(film, "N", p).normalized() - three(film, "P", p).normalized()).length());
  }
  EXPECT_GT(worst, 0.1);
}

}  // namespace
}  // namespace dapple
