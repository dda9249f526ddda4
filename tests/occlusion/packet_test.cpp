// Point packets: rays of one point that are traced together find what single rays find. Tests exact
// rays, prefiltered rays as the footprint goes to 0, closed forms, and various numbers of rays.
#include <gtest/gtest.h>

#include "dapple/error.hpp"
#include "support/scenes/traced_scenes.hpp"

namespace dapple {
namespace {

using namespace scene_test;

// `rays` cosine-weighted rays from each of `points` random points in `box`, like those of the AO
// pass.
std::vector<Ray> ao_rays(const Box3f& box, std::size_t points, std::size_t rays,
                         std::uint32_t seed) {
  Points random(seed);
  std::vector<Ray> result;
  for (std::size_t p = 0; p < points; ++p) {
    const V3f origin = box.center() + V3f(box.size() * random.in_cube(0.5f));
    const V3f normal = random.on_sphere();
    for (std::size_t r = 0; r < rays; ++r) {
      const V3f direction = normal + random.on_sphere() * 0.9999f;
      const float cosine = direction.normalized().dot(normal);
      Ray ray = make_ray(origin, direction,
                         static_cast<float>(kPi) / (static_cast<float>(rays) * cosine));
      ray.key = static_cast<std::uint32_t>(result.size()) * 0x9e3779b9u;
      result.push_back(ray);
    }
  }
  return result;
}

// A device on which all rays are traced singly.
const Device& single_ray_device() {
  static const Device device("", "", Packets::none);
  return device;
}

std::vector<Occlusion> packets(const SceneOnDevice& scene, const std::vector<Ray>& rays,
                               float footprint, std::size_t rays_per_point) {
  return trace(device(), scene.uploaded, rays, Estimator::prefiltered, footprint, rays_per_point);
}

std::vector<Occlusion> exact_packets(const SceneOnDevice& scene, const std::vector<Ray>& rays,
                                     std::size_t rays_per_point) {
  return trace(device(), scene.uploaded, rays, Estimator::exact, 1, rays_per_point);
}

int count_different(const std::vector<Occlusion>& a, const std::vector<Occlusion>& b) {
  int different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    different += std::fabs(a[i].transmittance - b[i].transmittance) > 1e-4f;
  }
  return different;
}

// Sum of the node visits of all rays.
double sum_of_visits(const std::vector<Occlusion>& found) {
  double sum = 0;
  for (const Occlusion& one : found) sum += one.visits & 65535u;
  return sum;
}

// Packets compute the edge functions of triangles in another order. So a ray within rounding of an
// edge may pass it on the other side: at most 1 ray in 1000 (reference_traversal_test.cpp).
TEST(Packet, EqualsExactRayByRayWhenExactAndAsTheFootprintGoesToZero) {
  std::vector<Scene> scenes;
  scenes.push_back(make_procedural("scene:tree?leaves=2000"));
  scenes.push_back(forest_scaled_non_uniformly());
  scenes.push_back(textured_cards());
  for (Scene& made : scenes) {
    const SceneOnDevice scene(std::move(made));
    const Box3f box = scene.bvh.bounds;
    for (const std::size_t rays : {4u, 9u, 25u, 64u, 65u, 200u}) {
      std::vector<Ray> queue = ao_rays(box, 6400 / rays, rays, 21);
      // Some rays end at a distance, as rays to a light do, some never, and some before they start.
      for (std::size_t i = 0; i < queue.size(); ++i) {
        if (i % 3 == 0) queue[i].t_max = 0.01f * static_cast<float>(i % 100);
        if (i % 17 == 0) queue[i].t_max = -1;
      }
      const std::vector<Occlusion> exact = scene.trace(queue, Estimator::exact);
      EXPECT_LT(mean_transmittance(exact), 0.97) << "nothing in the way";
      for (const float footprint : {0.0f, 1e-7f}) {
        const int different = count_different(packets(scene, queue, footprint, rays), exact);
        std::printf("%s, %zu rays, footprint %g: %d differ\n", scene.scene.source.c_str(), rays,
                    footprint, different);
        EXPECT_LE(different, 6) << rays;
      }
      const std::vector<Occlusion> together = exact_packets(scene, queue, rays);
      EXPECT_LE(count_different(together, exact), 6) << rays;
      if (device().info().kind == "CPU") {  // others trace single rays
        EXPECT_LT(sum_of_visits(together), 0.9 * sum_of_visits(exact)) << rays;
      }
    }
  }
}

// Points on the scene's surfaces with their normals, like those of a baker.
struct BakedPoints {
  std::vector<V3f> positions, normals;
};

BakedPoints points_on(const SceneOnDevice& scene, std::size_t count) {
  BakedPoints points;
  std::vector<Ray> rays = rays_across(scene.bvh.bounds, 24 * count, 0, 31);
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i].key = static_cast<uint>(i) * 0x9e3779b9u;
  for (const SurfacePoint& hit : closest_hits(device(), scene.uploaded, rays)) {
    if (hit.t < 0 || points.positions.size() == count) continue;
    points.positions.emplace_back(hit.position[0], hit.position[1], hit.position[2]);
    points.normals.emplace_back(hit.normal[0], hit.normal[1], hit.normal[2]);
  }
  return points;
}

OcclusionOptions bake_options(Estimator estimator, float footprint, int rays = 64) {
  OcclusionOptions options;
  options.rays = rays;
  options.estimator = estimator;
  options.footprint = footprint;
  return options;
}

std::vector<float> bake(const SceneOnDevice& scene, const BakedPoints& points,
                        const OcclusionOptions& options) {
  return occlusion(device(), scene.uploaded, points.positions, points.normals, options);
}

// The same scene on a device that traces every ray singly.
std::vector<float> bake_singly(const DeviceScene& scene, const BakedPoints& points,
                               const OcclusionOptions& options) {
  return occlusion(single_ray_device(), scene, points.positions, points.normals, options);
}

struct Difference {
  double mean, standard_error, rms;
};

// Both use the same rays, so that the noise of their directions cancels.
Difference difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0, square = 0;
  const auto n = static_cast<double>(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += d;
    square += d * d;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, square / n - mean * mean) / n), std::sqrt(square / n)};
}

TEST(Packet, AgreesWithPrefilteredAndConvergesToExact) {
  std::vector<Scene> scenes;
  scenes.push_back(make_procedural("scene:tree?leaves=20000"));
  scenes.push_back(make_procedural("scene:cloud?leaves=50000&opacity=0.2"));
  scenes.push_back(make_procedural("scene:forest?trees=40&leaves=2000"));
  scenes.push_back(forest_scaled_non_uniformly());
  for (Scene& made : scenes) {
    const SceneOnDevice scene(std::move(made));
    const char* name = scene.scene.source.c_str();
    const BakedPoints points = points_on(scene, 1500);
    ASSERT_GT(points.positions.size(), 300u);
    const DeviceScene for_single_rays = upload(single_ray_device(), scene.scene, scene.bvh);
    const std::vector<float> exact = bake(scene, points, bake_options(Estimator::exact, 0));
    Difference coarser{1, 0, 1};
    for (const float footprint : {4.0f, 1.0f, 0.25f, 1.0f / 16}) {
      const OcclusionOptions options = bake_options(Estimator::prefiltered, footprint);
      const std::vector<float> packet = bake(scene, points, options);
      const Difference error = difference(packet, exact);
      const Difference apart = difference(packet, bake_singly(for_single_rays, points, options));
      std::printf(
          "%s, footprint %g: packet - exact %+.4f (+-%.4f), packet - single %+.4f "
          "(rms %.4f)\n",
          name, footprint, error.mean, error.standard_error, apart.mean, apart.rms);
      // Only the direction along which a covered child's optical depth is taken may differ.
      EXPECT_NEAR(apart.mean, 0, 0.003) << name << " at " << footprint;
      EXPECT_LT(apart.rms, 0.005) << name << " at " << footprint;
      const double noise = 3 * std::hypot(error.standard_error, coarser.standard_error);
      EXPECT_LE(std::fabs(error.mean), std::fabs(coarser.mean) + noise) << name << " " << footprint;
      coarser = error;
    }
    // Footprints far smaller than leaves cover almost no node.
    const OcclusionOptions narrow = bake_options(Estimator::prefiltered, 1e-5f);
    EXPECT_NEAR(difference(bake(scene, points, narrow), exact).mean, 0, 2e-4) << name;
  }
}

// As in closed_form_test.cpp and ao_distance_test.cpp, which derive the tolerances.
OcclusionOptions many_rays(float footprint) {
  OcclusionOptions options;
  options.rays = 1 << 16;
  options.estimator = Estimator::prefiltered;
  options.footprint = footprint;
  return options;
}

constexpr V3f kOrigin(0, 0, 0), kUp(0, 1, 0);

TEST(Packet, MatchesClosedFormsOfADiskAStackAndAPlaneWithFalloff) {
  const SceneOnDevice disk(make_procedural("scene:disk?radius=2&height=1&opacity=0.85"));
  EXPECT_NEAR(disk.occlusion_at(kOrigin, kUp, many_rays(1)), 1 - 0.85 * 0.8, 1.5e-3);
  EXPECT_NEAR(disk.occlusion_at(kOrigin, kUp, many_rays(1024)), 1 - 0.85 * 0.8, 0.03);

  // Sheets so wide that less than 1e-3 of the cosine-weighted hemisphere passes beside them.
  Scene sheets;
  sheets.materials.push_back(material_of(0.25f));
  Mesh mesh;
  for (int i = 0; i < 4; ++i) {
    append_grid(mesh, {-40, 1 + 0.1f * static_cast<float>(i), -40}, {80, 0, 0}, {0, 0, 80}, 160, 0);
  }
  place(sheets, std::move(mesh));
  const SceneOnDevice stack(std::move(sheets));
  EXPECT_NEAR(stack.occlusion_at(kOrigin, kUp, many_rays(1)), std::pow(0.75, 4), 2.5e-3);

  Scene ceiling;
  ceiling.materials.push_back(material_of(0.4f));
  place(ceiling, square_mesh(64, 1, 128, 0));
  const SceneOnDevice plane(std::move(ceiling));
  const DeviceScene for_single_rays = upload(single_ray_device(), plane.scene, plane.bvh);
  for (const double distance : {1.5, 3.0, 7.5}) {
    const double k = 1 / distance;
    for (const auto& [power, part] : {std::pair{0.0f, 1 - k * k}, {1.0f, (1 - k) * (1 - k)}}) {
      SCOPED_TRACE(testing::Message() << "distance " << distance << " power " << power);
      OcclusionOptions options = many_rays(1);
      options.distance = static_cast<float>(distance);
      options.falloff = power;
      EXPECT_NEAR(plane.occlusion_at(kOrigin, kUp, options), 1 - 0.4 * part, 2e-3);
      // Strips of the plane reach from overhead to far away, where they look small. For a ray that
      // hits one overhead the strip must not count as small.
      options.footprint = 1024;
      const float together = plane.occlusion_at(kOrigin, kUp, options);
      const float alone = occlusion(single_ray_device(), for_single_rays, std::vector{kOrigin},
                                    std::vector{kUp}, options)[0];
      std::printf("plane: closed form %.4f, packet %.4f, single %.4f\n", 1 - 0.4 * part, together,
                  alone);
      EXPECT_NEAR(together, alone, 0.01);
      EXPECT_NEAR(together, 1 - 0.4 * part, 0.04);
    }
  }
}

TEST(Packet, ANodeThatHoldsTheRaysEndIsOpened) {
  for (const float distance : {0.5f, 1.0f, 3.0f, 10.0f, 30.0f}) {
    const SquareBeyond square(distance);
    const SceneOnDevice traced(square.scene);
    const std::vector<Ray> ending(8, make_ray(square.origin, {0, 1, 0}, 6, distance));
    const std::vector<Ray> endless(8, make_ray(square.origin, {0, 1, 0}, 6));
    for (int i = 0; i < 8; ++i) {
      EXPECT_EQ(packets(traced, ending, 1e6f, 8)[i].transmittance, 1.0f) << distance;
      EXPECT_LT(packets(traced, endless, 1e6f, 8)[i].transmittance, 0.9f) << distance;
    }
  }
}

TEST(Packet, FewRaysAreTracedSinglyAndRaysOfOtherPointsAreRefused) {
  if (device().info().kind != "CPU") GTEST_SKIP() << "only CPUs trace packets";
  const SceneOnDevice scene(make_procedural("scene:tree?leaves=2000"));
  const BakedPoints points = points_on(scene, 200);
  const DeviceScene for_single_rays = upload(single_ray_device(), scene.scene, scene.bvh);
  for (const int rays : {1, 2, 3}) {
    const OcclusionOptions options = bake_options(Estimator::prefiltered, 1, rays);
    EXPECT_EQ(bake(scene, points, options), bake_singly(for_single_rays, points, options)) << rays;
  }

  std::vector<Ray> rays = ao_rays(scene.bvh.bounds, 100, 64, 3);
  const std::vector<Occlusion> alone = scene.trace(rays, Estimator::prefiltered);
  // A packet's visits are counted once: fewer than a third of the visits of single rays.
  const double shared_visits = sum_of_visits(packets(scene, rays, 1, 64));
  const double own_visits = sum_of_visits(alone);
  std::printf("visits per ray: %.2f together, %.2f alone\n", shared_visits / 6400,
              own_visits / 6400);
  EXPECT_GT(shared_visits, 0);
  EXPECT_LT(shared_visits, own_visits / 3);

  EXPECT_THROW(packets(scene, rays, 1, 63), Error);  // 6400 is no multiple of 63
  EXPECT_THROW(packets(scene, rays, 1, 0), Error);
  rays[70].origin[1] += 1;
  EXPECT_THROW(packets(scene, rays, 1, 64), Error);
  rays[70] = rays[71];
  rays[70].light = 1;
  EXPECT_THROW(packets(scene, rays, 1, 64), Error);
}

}  // namespace
}  // namespace dapple
