// bake() of instances: their values against means over many points of the surface, and the errors
// that are reported.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bake/two_sided.hpp"
#include "dapple/bake.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// Nine trees in a square, close enough to occlude each other.
Scene grove() {
  Scene scene = make_procedural("scene:tree?leaves=2000");
  const V3f size = scene_bounds(scene).size();
  const std::vector<Instance> tree = scene.instances;
  scene.instances.clear();
  scene.lights.clear();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      for (Instance instance : tree) {
        instance.to_world *= M44f().setTranslation(V3f(0.8f * size.x * static_cast<float>(column),
                                                       0, 0.8f * size.z * static_cast<float>(row)));
        scene.instances.push_back(instance);
      }
    }
  }
  return scene;
}

BakeOptions of_instances(float target) {
  BakeOptions options;
  options.vertices = false;
  options.instances = true;
  options.sides = BakeSides::mean;
  options.normals = Normals::geometric;
  options.estimator = Estimator::exact;
  options.target_error = target;
  options.rays = 16384;
  return options;
}

/// AO of both sides at `count` random points of an instance, one after the other.
std::vector<float> ao_of_surface(const Scene& scene, const Instance& instance, int count,
                                 int rays) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  std::vector<double> areas;
  const auto corner = [&](std::size_t t, std::size_t k) {
    return mesh.positions[mesh.indices[3 * t + k]];
  };
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t)
    areas.push_back(
        double{(corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).length()});
  std::mt19937 random(7);
  std::discrete_distribution<std::size_t> triangle(areas.begin(), areas.end());
  std::uniform_real_distribution<float> uniform;
  std::vector<V3f> points, normals;
  for (int i = 0; i < count; ++i) {
    const std::size_t t = triangle(random);
    const float u = std::sqrt(uniform(random)), v = uniform(random);
    const V3f local =
        corner(t, 0) * (1 - u) + corner(t, 1) * (u * (1 - v)) + corner(t, 2) * (u * v);
    V3f a, b;
    instance.to_world.multDirMatrix(corner(t, 1) - corner(t, 0), a);
    instance.to_world.multDirMatrix(corner(t, 2) - corner(t, 0), b);
    for (const float side : {1.0f, -1.0f}) {
      points.push_back(local * instance.to_world);
      normals.push_back(a.cross(b).normalized() * side);
    }
  }
  const SceneOnDevice on_device(scene);
  OcclusionOptions options;
  options.rays = rays;
  options.estimator = Estimator::exact;
  return occlusion(device(), on_device.uploaded, points, normals, options);
}

double mean_of_surface(const Scene& scene, const Instance& instance, int count) {
  double sum = 0;
  for (const float ao : ao_of_surface(scene, instance, count, 16)) sum += double{ao};
  return sum / (2 * count);
}

/// By so many rays that noise does not make a side the brighter one.
double mean_of_brighter_sides(const Scene& scene, const Instance& instance, int count) {
  const std::vector<float> ao = ao_of_surface(scene, instance, count, 1024);
  double sum = 0;
  for (std::size_t i = 0; i < ao.size(); i += 2) sum += double{std::max(ao[i], ao[i + 1])};
  return sum / count;
}

// The squares of their areas are beyond the range of floats.
TEST(InstanceBake, ValuesOfExtremeScalesAreNumbers) {
  for (const float scale : {1e-13f, 1e13f}) {
    Scene scene;
    scene.materials.resize(1);
    place(scene, square_mesh(scale > 1 ? 1e-8f : 1e8f, 0, 2, 0));
    scene.instances[0].to_world.setScale(V3f(scale, scale, 2 * scale));
    for (const float target : {0.0f, 0.05f}) {
      BakeOptions options = of_instances(target);
      options.rays = 64;
      for (const float ao : bake(scene, options).instance_ao)
        EXPECT_TRUE(ao >= 0 && ao <= 1) << scale << " " << ao;
    }
  }
}

TEST(InstanceBake, ValuesAreMeansOverTheSurface) {
  const Scene scene = grove();
  const BakeResult result = bake(scene, of_instances(0.01f));
  for (const std::size_t i : {std::size_t{0}, scene.instances.size() / 2})
    EXPECT_NEAR(result.instance_ao.at(i), mean_of_surface(scene, scene.instances[i], 8000), 0.02)
        << i;
}

// A plate of 2 m by 2 m through the middle of a cube, which hides a quarter of it, and a smaller
// one inside of the cube. Its other samples see at least half of the sky.
TEST(InstanceBake, SamplesInsideClosedGeometryDoNotCount) {
  Scene scene = make_procedural("scene:cube?divisions=4");
  scene.lights.clear();
  const Box3f cube = scene_bounds(scene);
  const float side = cube.size().x, height = 0.5f * (cube.min.y + cube.max.y);
  Mesh plate;
  append_grid(plate, V3f(-side, 0, -side), V3f(0, 0, 2 * side), V3f(2 * side, 0, 0), 4, 0);
  scene.meshes.push_back(plate);
  for (const float size : {1.0f, 0.2f}) {
    Instance instance;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
    instance.to_world.setScale(size);
    instance.to_world *= M44f().setTranslation(
        V3f(0.5f * (cube.min.x + cube.max.x), height, 0.5f * (cube.min.z + cube.max.z)));
    scene.instances.push_back(instance);
  }
  BakeOptions options = of_instances(0.005f);
  options.sides = BakeSides::front;
  const BakeResult result = bake(scene, options);
  const std::size_t plates = scene.instances.size() - 2;
  EXPECT_GT(result.statistics.inside_samples, 10u);
  EXPECT_GT(result.instance_ao.at(plates), 0.8f) << "0.61 with those inside";
  EXPECT_LT(result.instance_ao.at(plates), 0.95f);
  EXPECT_EQ(result.instance_ao.at(plates + 1), 0.0f);
}

TEST(InstanceBake, ErrorsAreWithinTheTargetAndReported) {
  const Scene scene = grove();
  const BakeResult truth = bake(scene, of_instances(0));
  std::uint64_t rays = 0;
  for (const float target : {0.06f, 0.01f}) {
    const BakeResult found = bake(scene, of_instances(target));
    double square = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i)
      square += std::pow(double{found.instance_ao[i]} - double{truth.instance_ao[i]}, 2);
    const auto count = static_cast<double>(scene.instances.size());
    const double estimated = std::sqrt(found.statistics.squared_errors / count);
    EXPECT_LE(std::sqrt(square / count), double{target}) << target;
    EXPECT_LE(estimated, double{target}) << "of each, so of all";
    EXPECT_GE(estimated, double{target} / 3) << "no more samples than it takes";
    EXPECT_GT(found.statistics.rays, 2 * rays);
    rays = found.statistics.rays;
  }
}

// The meshes, too, choose a footprint, each by its own bias.
TEST(InstanceBake, OfMeshesAloneHaveTheFootprintOfTheirSurroundings) {
  const Scene scene = grove();
  BakeOptions options = of_instances(0);
  options.estimator = Estimator::prefiltered;
  options.placement = BakePlacement::alone;
  options.footprint = 16;
  options.rays = 512;
  options.max_bias = 0.003f;
  const BakeResult instances = bake(scene, options);
  EXPECT_LT(instances.statistics.footprint, options.footprint);
  options.vertices = true;
  const BakeResult both = bake(scene, options);
  EXPECT_EQ(both.statistics.footprint, instances.statistics.footprint);
  EXPECT_EQ(both.instance_ao, instances.instance_ao);
}

TEST(InstanceBake, TheBrighterSideIsNotBrightenedByNoise) {
  Scene scene = make_procedural("scene:cloud?leaves=3000&opacity=0.5");
  scene.lights.clear();
  BakeOptions options = of_instances(0);
  options.rays = 8192;
  const auto value_of = [&](BakeSides sides) {
    options.sides = sides;
    return bake(scene, options).instance_ao.at(0);
  };
  const float mean = value_of(BakeSides::mean), brighter = value_of(BakeSides::max);
  EXPECT_GT(brighter, mean);
  EXPECT_NEAR(brighter, mean_of_brighter_sides(scene, scene.instances[0], 4000), 0.01);
}

TEST(InstanceBake, RaysAreTheirNumberWithoutATarget) {
  const Scene scene = grove();
  BakeOptions options = of_instances(0);
  options.rays = 80;
  EXPECT_EQ(bake(scene, options).statistics.rays, scene.instances.size() * 2 * 80u)
      << "of both sides";
}

// Strands have segments in place of triangles, and no sides.
TEST(InstanceBake, StrandsOfADoubleSidedMaterialAreLeftOut) {
  Scene scene = make_procedural("scene:hair?strands=20");
  for (Material& material : scene.materials) material.double_sided = true;
  const TwoSided two_sided(scene, BakeSides::automatic);
  for (const Mesh& mesh : scene.meshes) {
    const std::vector<bool> triangles = two_sided.triangles(mesh);
    EXPECT_EQ(triangles.size(), mesh.primitive_count());
    if (mesh.has_strands()) {
      EXPECT_EQ(triangles, std::vector<bool>(mesh.primitive_count()));
    }
  }
}

// A shelf under a board, and a panel beside it that a node makes ten times as high.
TEST(InstanceBake, MeansAreOverTheSurfaceAsAnUnevenScalePlacesIt) {
  const V3f size(1, 10, 1);
  Scene scene;
  scene.materials.emplace_back();
  Mesh shelf;
  append_grid(shelf, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 4, 0);
  append_grid(shelf, {3, 0, 0}, {0, 1, 0}, {0, 0, 1}, 4, 0);
  Mesh high = shelf, boards;
  for (V3f& position : high.positions) position *= size;
  for (const float x : {0.0f, 50.0f})
    for (const float y : {-0.01f, 0.01f})
      append_grid(boards, {x - 1, y, -1}, {3, 0, 0}, {0, 0, 3}, 4, 0);
  scene.meshes = {shelf, high, boards};
  scene.instances = {
      {0, M44f().setScale(size)}, {1, M44f().setTranslation(V3f(50, 0, 0))}, {2, M44f()}};
  const BakeResult baked = bake(scene, of_instances(0.003f));
  EXPECT_GT(baked.instance_ao[1], 0.8f);
  EXPECT_NEAR(baked.instance_ao[0], baked.instance_ao[1], 0.01);
}

}  // namespace
}  // namespace dapple
