// Pixel packets: rays that start near each other are traced together. Each finds what a single ray
// finds (within roundings), and the same bits in every packet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "device/upload/scene_upload.hpp"
#include "support/queued_rays.hpp"
#include "support/scenes/curly_strands.hpp"

namespace dapple {
namespace {

using namespace scene_test;

std::vector<Occlusion> together(const SceneOnDevice& scene, const std::vector<Ray>& rays,
                                Estimator estimator) {
  return trace_queue(scene, rays, estimator, 1, RayOrder::by_pixel);
}

std::vector<float> transmittances(const std::vector<Occlusion>& found) {
  std::vector<float> values;
  for (const Occlusion& one : found) values.push_back(one.transmittance);
  return values;
}

Scene forest_with_sheared_trees() {
  Scene scene = make_procedural("scene:forest?trees=9&leaves=500");
  scene.instances[0].to_world[1][0] += 0.3f;
  return scene;
}

/// Leaves, and strands in two instances, one of them mirrored and smaller.
Scene strands_and_leaves() {
  Scene scene = make_procedural("scene:cloud?leaves=500&opacity=0.5");
  scene.materials.push_back(material_of(0.3f));
  const auto hair = static_cast<std::uint32_t>(scene.materials.size() - 1);
  place(scene, curly_strands({.strands = 200, .radius = 0.004f}, hair));
  M44f over;
  over.scale(V3f(0.5f, -0.5f, 0.5f));
  over.translate(V3f(0.2f, 0.3f, 0));
  scene.instances.push_back({static_cast<std::uint32_t>(scene.meshes.size() - 1), over, -1});
  return scene;
}

/// Moves all vertices away from the origin, where floats are less dense.
Scene moved(Scene scene, const V3f& by) {
  for (Mesh& mesh : scene.meshes)
    for (V3f& position : mesh.positions) position += by;
  return scene;
}

Scene scene_named(const std::string& name) {
  if (name == "far") return moved(make_procedural("scene:tree?leaves=3000"), V3f(40, -20, 10));
  if (name == "sheared") return forest_with_sheared_trees();
  if (name == "strands") return strand_scene(curly_strands({}), 0.3f);
  return name == "strands and leaves" ? strands_and_leaves() : make_procedural(name);
}

class PixelPacketRays : public testing::TestWithParam<const char*> {
 protected:
  const SceneOnDevice scene_{scene_named(GetParam())};
  const std::vector<Ray> rays_ = make_rays();

 private:
  std::vector<Ray> make_rays() const {
    const float radius = scene_.bvh.bounds.size().length();
    std::vector<Ray> rays = rays_through(scene_.bvh.bounds, 5003, radius, 0.01f, 7);
    Points random(3);
    for (Ray& ray : rays) {
      ray.key = static_cast<std::uint32_t>(random.unit() * 4e9f);
      ray.first_area = 1e-4f;
      if (random.unit() < 0.3f) ray.t_max = radius * 2 * random.unit();
    }
    // Some rays are perpendicular to an axis, with zeros of both signs.
    for (std::size_t i = 0; i < rays.size(); i += 13)
      rays[i].direction[i % 3] = std::copysign(0.0f, rays[i].direction[i % 3]);
    // Some rays end before they start, among them a long row.
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (i % 19 == 0 || (i > 1000 && i < 2100)) rays[i].t_max = -1;
    return rays;
  }
};

// Kernels round differently, so near borders of boxes and triangles a ray may hit in one only.
TEST_P(PixelPacketRays, AgreeWithSingleRays) {
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const auto alone = scene_.trace(rays_, estimator);
    const auto found = together(scene_, rays_, estimator);
    int different = 0;
    double sum = 0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      different += std::fabs(found[i].transmittance - alone[i].transmittance) > 1e-4f;
      sum += found[i].transmittance - alone[i].transmittance;
    }
    EXPECT_LE(different, 5);
    EXPECT_LT(std::fabs(sum / static_cast<double>(rays_.size())), 2e-4);
  }
}

TEST_P(PixelPacketRays, FindTheSameBitsInAnyPacket) {
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    std::vector<float> found = transmittances(together(scene_, rays_, estimator));
    std::vector<Ray> reversed(rays_.rbegin(), rays_.rend());
    std::vector<float> backwards = transmittances(together(scene_, reversed, estimator));
    std::reverse(backwards.begin(), backwards.end());
    EXPECT_EQ(found, backwards);
    const std::vector<Ray> few(rays_.begin() + 100, rays_.begin() + 137);
    const std::vector<float> of_few = transmittances(together(scene_, few, estimator));
    EXPECT_TRUE(std::equal(of_few.begin(), of_few.end(), found.begin() + 100));
  }
}

/// The rays whose direction has one of the eight combinations of signs, and what they found.
std::pair<std::vector<Ray>, std::vector<float>> of_way(int way, const std::vector<Ray>& rays,
                                                       const std::vector<float>& found) {
  std::vector<Ray> alike;
  std::vector<float> of_alike;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float* d = rays[i].direction;
    if (std::signbit(d[0]) + 2 * std::signbit(d[1]) + 4 * std::signbit(d[2]) != way) continue;
    alike.push_back(rays[i]);
    of_alike.push_back(found[i]);
  }
  return {alike, of_alike};
}

// Packets in which all directions have the same signs are traced by special loops.
TEST_P(PixelPacketRays, FindTheSameBitsAmongRaysOfTheSameSigns) {
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const std::vector<float> found = transmittances(together(scene_, rays_, estimator));
    for (int way = 0; way < 8; ++way) {
      const auto [alike, of_all] = of_way(way, rays_, found);
      ASSERT_FALSE(alike.empty());
      EXPECT_EQ(transmittances(together(scene_, alike, estimator)), of_all) << "way " << way;
    }
  }
}

// The same for point packets, whose coordinates are relative to the shared origin.
TEST_P(PixelPacketRays, OfOnePointFindTheSameBitsAmongRaysOfTheSameSigns) {
  std::vector<Ray> rays(rays_.begin(), rays_.begin() + 512);
  for (Ray& ray : rays) {
    std::copy_n(rays_[1].origin, 3, ray.origin);
    ray.t_max = 1e9f;
  }
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const auto of_point = [&](const std::vector<Ray>& some) {
      return transmittances(
          dapple::trace(device(), scene_.uploaded, some, estimator, 1, some.size()));
    };
    const std::vector<float> found = of_point(rays);
    for (int way = 0; way < 8; ++way) {
      const auto [alike, of_all] = of_way(way, rays, found);
      ASSERT_GE(alike.size(), 32u);  // enough for a packet
      EXPECT_EQ(of_point(alike), of_all) << "way " << way;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, PixelPacketRays,
                         testing::Values("scene:tree?leaves=3000",
                                         "scene:cloud?leaves=3000&opacity=0.2",
                                         "scene:forest?trees=9&leaves=500", "sheared", "strands",
                                         "strands and leaves", "far"));

/// Squares of side 2 `half` perpendicular to the axes, a kilometre away. Their boxes are only as
/// thick as roundings.
Scene far_sheets(float half) {
  Scene scene;
  scene.materials.push_back(material_of(0.3f));
  Mesh mesh;
  Points random(5);
  for (std::uint32_t i = 0; i < 400; ++i) {
    const V3f middle(random.unit(), random.unit(), random.unit());
    V3f u(0.0f), v(0.0f);
    u[(i + 1) % 3] = v[(i + 2) % 3] = half;
    for (const V3f& corner : {-u - v, u - v, u + v, v - u})
      mesh.positions.push_back(V3f(1000, -500, 250) + middle + corner);
    const std::uint32_t first = 4 * i;
    for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u})
      mesh.indices.push_back(first + corner);
  }
  mesh.materials.assign(mesh.indices.size() / 3, 0);
  place(scene, std::move(mesh), {});
  return scene;
}

TEST(PixelPacketRaysFarAway, FlatBoxesAreAsDeepAsForSingleRays) {
  const SceneOnDevice scene(far_sheets(0.04f));
  const std::vector<Ray> rays = rays_through(scene.bvh.bounds, 5003, 1, 0.02f, 7);
  double difference = 0, occluded = 0;
  const auto alone = scene.trace(rays, Estimator::prefiltered);
  const auto found = together(scene, rays, Estimator::prefiltered);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    difference += alone[i].transmittance - found[i].transmittance;
    occluded += 1 - alone[i].transmittance;
  }
  const auto count = static_cast<double>(rays.size());
  EXPECT_GT(occluded / count, 0.2) << "the case does not test much";
  // Roundings of thousands of depths, with both signs. Without the chord model it would be 0.0012.
  EXPECT_LT(std::fabs(difference), 3e-4 * occluded);
}

/// An oblique ray from five centimetres away through the square with this first corner. It crosses
/// the square a tenth of a float's last digit inside its edge.
Ray ray_inside_edge(const V3f* corner, Points& random) {
  using V3d = Imath::V3d;
  const V3d edge(corner[1] - corner[0]), other(corner[3] - corner[0]);
  const int axis = std::fabs(other.x) > 0 ? 0 : std::fabs(other.y) > 0 ? 1 : 2;
  const float side = corner[0][axis];
  const double inside = (std::nextafter(std::fabs(side), kInfinity) - std::fabs(side)) / 10.0;
  const V3d at = V3d(corner[0]) + edge * (0.2 + 0.6 * random.unit()) + other.normalized() * inside;
  const V3f normal = (corner[1] - corner[0]).cross(corner[3] - corner[0]).normalized();
  V3f away = random.on_sphere();
  while (std::fabs(away.dot(normal)) < 0.2f) away = random.on_sphere();
  const V3f from = V3f(at) + away * 0.05f;
  return make_ray(from, V3f(at - V3d(from)), 0, 0.1f);
}

// Boxes end where the squares end; without a margin for roundings, rays would miss them.
TEST(PixelPacketRaysFarAway, HitSquaresAtTheirEdges) {
  const SceneOnDevice scene(far_sheets(0.001f));
  const std::vector<V3f>& corners = scene.scene.meshes[0].positions;
  Points random(9);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i + 3 < corners.size(); i += 4)
    for (int k = 0; k < 10; ++k) rays.push_back(ray_inside_edge(&corners[i], random));
  int missed = 0;
  for (const Occlusion& one : together(scene, rays, Estimator::exact))
    missed += one.transmittance > 0.9f;
  EXPECT_EQ(missed, 0) << "of " << rays.size();
}

TEST(Trace, ALightNeverOccludesItsOwnRays) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  Light glow;
  glow.kind = LightKind::mesh;
  scene.lights.push_back(glow);
  place(scene, square_mesh(2, 1, 1, 0), {}, 0);
  const SceneOnDevice on_device(std::move(scene));
  std::vector<Ray> rays(32);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    rays[i].direction[1] = 1;
    rays[i].t_max = 2;
    rays[i].light = i / 8 % 2 == 0 ? 1u : 0u;  // eight rays a point
  }
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const auto found = trace(device(), on_device.uploaded, rays, estimator, 0, 8);
    for (std::size_t i = 0; i < rays.size(); ++i)
      EXPECT_EQ(found[i].transmittance, rays[i].light ? 1.0f : 0.0f) << i;
  }
}

}  // namespace
}  // namespace dapple
