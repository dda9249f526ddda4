// Compares the kernels' traversal with a scalar one on the host, ray by ray, and with testing every
// triangle of the scene.
#include "support/reference_traversal.hpp"

#include <gtest/gtest.h>

#include "passes/ray_packets.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

struct Agreement {
  int different = 0;  // number of transmittances that differ by more than 1e-4
  double kernel_visits = 0, host_visits = 0, kernel_tests = 0, host_tests = 0;
  double mean_difference = 0;
};

Agreement compare(const SceneOnDevice& scene, const std::vector<Ray>& rays, Estimator estimator,
                  float footprint) {
  const std::vector<Occlusion> found = scene.trace(rays, estimator, footprint);
  const ReferenceTraversal reference(scene.bvh, estimator, footprint);
  Agreement agreement;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const ReferenceTraversal::Result expected = reference.trace(rays[i]);
    const float difference = found[i].transmittance - expected.transmittance;
    agreement.different += std::fabs(difference) > 1e-4f;
    agreement.mean_difference += difference / static_cast<double>(rays.size());
    agreement.kernel_visits += found[i].visits & 65535u;
    agreement.kernel_tests += found[i].visits >> 16;
    agreement.host_visits += expected.visits;
    agreement.host_tests += expected.tests;
  }
  return agreement;
}

// Half of the rays come from outside, half start inside as AO rays do. Solid angles range from
// those of 4096 rays a point to those of 4; some rays have an end or a first area.
std::vector<Ray> mixed_rays(const Box3f& box, std::size_t count) {
  std::vector<Ray> rays = rays_through(box, count / 2, box.size().length(), 0, 21);
  Points points(22);
  while (rays.size() < count) {
    const V3f from(box.min.x + points.unit() * (box.max.x - box.min.x),
                   box.min.y + points.unit() * (box.max.y - box.min.y),
                   box.min.z + points.unit() * (box.max.z - box.min.z));
    rays.push_back(make_ray(from, points.on_sphere()));
  }
  for (Ray& ray : rays) {
    ray.solid_angle = std::exp(std::log(0.8f) - 7 * points.unit());
    ray.first_area = points.unit() < 0.5f ? 0 : 0.01f * points.unit();
    if (points.unit() < 0.25f) ray.t_max = box.size().length() * points.unit();
  }
  return rays;
}

struct TraversalScene {
  const char* name;
  const char* source;
};

void PrintTo(const TraversalScene& scene, std::ostream* out) { *out << scene.source; }

class TraversalScenes : public ::testing::TestWithParam<TraversalScene> {};

// The two differ only in roundings: device compilers may contract a * b + c, and have another exp
// and log. So a ray within 1e-6 of an edge may hit the triangle in one and not in the other, a
// child that the footprint just covers may be opened, and a ray that grazes a box may visit it.
// Each happens at about (roundings of 1e-7) x (edges or children near the ray, about a hundred) x
// (their chance to be that close: 1e-7 of a leaf is 1e-5 of a ray's length). That is at most about
// 1 ray in 1000; here at most 20 of 20,000.
constexpr std::size_t kRays = 20000;
constexpr int kFlips = 20;

TEST_P(TraversalScenes, KernelsAgreeWithTheScalarTraversalRayByRay) {
  const char* const source = GetParam().source;
  Scene unbuilt = make_procedural(source);
  const SceneOnDevice scene(std::move(unbuilt));
  const std::vector<Ray> rays = mixed_rays(scene.bvh.bounds, kRays);
  struct Kind {
    Estimator estimator;
    float footprint;
  };
  for (const Kind& kind : {Kind{Estimator::exact, 1}, Kind{Estimator::prefiltered, 0},
                           Kind{Estimator::prefiltered, 0.25f}, Kind{Estimator::prefiltered, 1},
                           Kind{Estimator::prefiltered, 16}}) {
    SCOPED_TRACE(testing::Message()
                 << source << (kind.estimator == Estimator::exact ? " exact" : " prefiltered ")
                 << kind.footprint);
    const Agreement a = compare(scene, rays, kind.estimator, kind.footprint);
    std::printf(
        "%-34s %-11s %5.2f: %d differ, mean by %.1e; visits %.3f and %.3f, tests %.3f and %.3f\n",
        source, kind.estimator == Estimator::exact ? "exact" : "prefiltered", kind.footprint,
        a.different, a.mean_difference, a.kernel_visits / kRays, a.host_visits / kRays,
        a.kernel_tests / kRays, a.host_tests / kRays);
    EXPECT_LE(a.different, kFlips);
    // Scalar rays that are stopped go on to the ends of their rounds: 8.5 % more tests were seen.
    const double more = traces_scalar(device().context()) ? 0.1 : 0.0;
    EXPECT_GE(a.kernel_visits, 0.99 * a.host_visits);
    EXPECT_LE(a.kernel_visits, (1.01 + more) * a.host_visits);
    EXPECT_GE(a.kernel_tests, 0.99 * a.host_tests);
    EXPECT_LE(a.kernel_tests, (1.01 + more) * a.host_tests);
  }
}

INSTANTIATE_TEST_SUITE_P(
    , TraversalScenes,
    ::testing::Values(TraversalScene{"Tree", "scene:tree?leaves=2000"},
                      TraversalScene{"ThinTree", "scene:tree?leaves=2000&opacity=0.2"},
                      TraversalScene{"Forest", "scene:forest?trees=9&leaves=500&opacity=0.5"}),
    [](const auto& instance) { return std::string(instance.param.name); });

// Transmittance without any BVH: every triangle of every instance, in double precision.
double brute_force(const Scene& scene, const Ray& ray) {
  const V3d origin(ray.origin[0], ray.origin[1], ray.origin[2]);
  const V3d direction(ray.direction[0], ray.direction[1], ray.direction[2]);
  double transmittance = 1;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const Imath::M44d to_world(instance.to_world);
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      const auto corner = [&](int c) {
        return V3d(mesh.positions[mesh.indices[3 * t + c]]) * to_world - origin;
      };
      // Signed volumes of the ray with each edge (Kensler and Shirley, "Optimizing
      // Ray-Triangle Intersection via Automated Search", 2006).
      const V3d a = corner(0), b = corner(1), c = corner(2);
      const double u = direction.dot(b.cross(c)), v = direction.dot(c.cross(a)),
                   w = direction.dot(a.cross(b));
      if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) continue;
      const double volume = a.dot(b.cross(c)), distance = volume / (u + v + w);
      if (!(distance > 0 && distance < ray.t_max)) continue;
      const Material& material = scene.materials[mesh.materials[t]];
      transmittance *= material.alpha_mode == AlphaMode::opaque ? 0.0 : 1.0 - material.alpha;
    }
  }
  return transmittance;
}

TEST(Traversal, ExactAgreesWithTryingEveryTriangle) {
  for (const char* name :
       {"scene:tree?leaves=1000&opacity=0.4", "scene:forest?trees=4&leaves=300&opacity=0.4"}) {
    const SceneOnDevice scene(make_procedural(name));
    const std::vector<Ray> rays = mixed_rays(scene.bvh.bounds, 1500);
    const std::vector<Occlusion> found = scene.trace(rays, Estimator::exact);
    int different = 0, occluded = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double expected = brute_force(scene.scene, rays[i]);
      occluded += expected < 1;
      different += std::fabs(found[i].transmittance - expected) > 1e-4;
    }
    std::printf("%s: %d of %zu differ, %d occluded\n", name, different, rays.size(), occluded);
    EXPECT_LE(different, 2) << name;  // rays within rounding of an edge, as above
    EXPECT_GT(occluded, 200) << name;
  }
}

}  // namespace
}  // namespace dapple
