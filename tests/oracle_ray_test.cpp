// The exact estimator against Embree, ray by ray.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "embree_oracle.hpp"
#include "oracle_scenes.hpp"

namespace dapple::oracle {
namespace {

constexpr std::size_t kRays = 100'000;

/// A place on a surface, surfaces chosen by number and not by area, so that small ones count.
V3d random_target(const Scene& scene, Random& random) {
  const auto pick = [&](std::size_t count) {
    return static_cast<std::size_t>(random.real() * static_cast<double>(count));
  };
  const Instance& instance = scene.instances[pick(scene.instances.size())];
  const Mesh& mesh = scene.meshes[instance.mesh];
  const std::uint32_t* corner = &mesh.indices[3 * pick(mesh.triangle_count())];
  const double root = std::sqrt(random.real()), share = random.real();
  const V3d a(mesh.positions[corner[0]]), b(mesh.positions[corner[1]]),
      c(mesh.positions[corner[2]]);
  const V3d point = a * (1 - root) + b * (root * share) + c * (root * (1 - share));
  return point * Imath::M44d(instance.to_world);
}

/// From anywhere in the scene's box, grown by a quarter. Of four rays three are aimed at a
/// surface, one goes anywhere; every other ray ends somewhere, as light rays do.
std::vector<Segment> random_segments(const Scene& scene, std::uint64_t seed) {
  Random random(seed);
  const Box3f box = scene_bounds(scene);
  const V3d margin = V3d(box.size()) / 8.0;
  const V3d low = V3d(box.min) - margin, high = V3d(box.max) + margin;
  std::vector<Segment> segments(kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    V3d origin;
    for (int k = 0; k < 3; ++k) origin[k] = random.between(low[k], high[k]);
    const V3d way = random_target(scene, random) - origin;
    segments[i].origin = V3f(origin);
    segments[i].direction = V3f(i % 4 == 3 ? random.direction() : way.normalized());
    if (i % 2) segments[i].t_max = static_cast<float>(2 * random.real() * way.length());
  }
  return segments;
}

std::vector<Occlusion> trace_exact(const OnDevice& on_device,
                                   const std::vector<Segment>& segments) {
  std::vector<Ray> rays;
  for (const Segment& s : segments) {
    rays.push_back({{s.origin.x, s.origin.y, s.origin.z},
                    s.t_max,
                    {s.direction.x, s.direction.y, s.direction.z},
                    0, 0, 0, 1, 0});
  }
  return trace(on_device.device, on_device.uploaded, rays, Estimator::exact);
}

struct Disagreement {
  std::size_t rays = 0;  ///< that differ by more than the tolerance
  double mean = 0;       ///< signed, over all rays
  double grey = 0;       ///< share of rays of transmittance in (0, 1): what makes a test severe
};

Disagreement compare(const EmbreeOracle& oracle, const std::vector<Segment>& segments,
                     const std::vector<Occlusion>& ours, double tolerance) {
  std::vector<double> theirs(segments.size());
  tbb::parallel_for(std::size_t{0}, segments.size(),
                    [&](std::size_t i) { theirs[i] = oracle.transmittance(segments[i]); });
  Disagreement found;
  const auto count = static_cast<double>(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const double difference = ours[i].transmittance - theirs[i];
    found.rays += !(std::fabs(difference) <= tolerance);
    found.mean += difference / count;
    found.grey += theirs[i] > 0 && theirs[i] < 1 ? 1 / count : 0;
  }
  return found;
}

/// `loaded` goes to Embree as it is, to the device as `prepared`.
Disagreement disagreement(const Scene& loaded, const OnDevice& prepared, double tolerance,
                          const char* label) {
  const std::vector<Segment> segments = random_segments(loaded, 1);
  const Disagreement found =
      compare(EmbreeOracle(loaded), segments, trace_exact(prepared, segments), tolerance);
  std::printf("%s: %zu of %zu rays differ by more than %g; mean difference %.1e; %.0f %% grey\n",
              label, found.rays, kRays, tolerance, found.mean, 100 * found.grey);
  return found;
}

Scene merged(Scene scene) {
  merge_single_instances(scene);
  return scene;
}

/// Every combination of wrap modes and filter, on small images of sides that are no powers of
/// two, and of both alpha modes, with and without texture and vertex alpha.
void add_every_material(Scene& scene, Random& random) {
  for (const Wrap s : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
    for (const Wrap t : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
      for (const bool nearest : {false, true}) {
        Texture texture{"random", 5, 3, {}, s, t, nearest};
        for (int i = 0; i < 15; ++i) {
          texture.alpha.push_back(static_cast<std::uint8_t>(random.bits()));
        }
        scene.textures.push_back(texture);
      }
    }
  }
  for (int texture = -1; texture < static_cast<int>(scene.textures.size()); ++texture) {
    for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
      for (const bool vertex_alpha : {false, true}) {
        Material material;
        material.alpha_mode = mode;
        material.alpha = static_cast<float>(random.between(0.5, 1));
        material.alpha_cutoff = static_cast<float>(random.between(0.1, 0.5));
        material.alpha_texture = texture;
        material.uses_vertex_alpha = vertex_alpha;
        scene.materials.push_back(material);
      }
    }
  }
}

/// Triangles at random in a cube of side 2 about the origin, of all the scene's materials.
Mesh random_triangles(const Scene& scene, Random& random) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const V3d centre(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    for (std::uint32_t k = 0; k < 3; ++k) {
      mesh.indices.push_back(3 * i + k);
      mesh.positions.emplace_back(centre + random.direction() * 0.2);
      mesh.uvs.emplace_back(random.between(-3, 3), random.between(-3, 3));
      mesh.vertex_alpha.push_back(static_cast<float>(random.real()));
    }
    mesh.materials.push_back(i % static_cast<std::uint32_t>(scene.materials.size()));
  }
  return mesh;
}

/// Four placements: as it is, mirrored, stretched and sheared.
Scene soup_of_every_material() {
  Random random(2);
  Scene scene;
  scene.source = "soup";
  add_every_material(scene, random);
  scene.meshes.push_back(random_triangles(scene, random));
  const M44f placements[] = {
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
      {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1},
      {0, 3, 0, 0, -0.5f, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 1},
      {1, 0, 0, 0, 0.7f, 0.5f, 0.2f, 0, 0, -0.4f, 1, 0, 1, 1, -1, 1},
  };
  for (const M44f& to_world : placements) scene.instances.push_back({0, to_world, -1});
  return scene;
}

}  // namespace

TEST(Oracle, GreySheetsMultiply) {
  const EmbreeOracle oracle(load_scene("scene:greys"));
  EXPECT_NEAR(oracle.transmittance({V3f(0.3f, 5, 0.2f), V3f(0, -1, 0), 4.99f}), 0.375, 1e-6);
}

TEST(OracleRays, EveryMaterialInEveryPlacementTransmitsAsInEmbree) {
  const Scene scene = soup_of_every_material();
  disagreement(scene, OnDevice(scene), 1e-4, "soup");
}

TEST(OracleRays, ProceduralPlantsTransmitAsInEmbree) {
  const Scene tree = load_scene("scene:tree?leaves=3000");
  disagreement(tree, OnDevice(merged(tree)), 1e-4, "tree");
  const Scene forest = load_scene("scene:forest?trees=9&leaves=500");
  const OnDevice instanced(merged(forest));
  EXPECT_TRUE(instanced.bvh.has_top);
  disagreement(forest, instanced, 1e-4, "forest");
}

TEST(OracleRays, TheSaplingTransmitsAsInEmbree) {
  DAPPLE_SKIP_WITHOUT(shared_scene("sapling_100k.glb"));
  const Scene sapling = load_sapling();
  disagreement(sapling, OnDevice(merged(sapling)), 1e-4, "sapling");
}

TEST(OracleRays, TheTexturedPineTransmitsAsInEmbree) {
  DAPPLE_SKIP_WITHOUT(shared_scene("smallpine"));
  const Scene pine = load_pine();
  disagreement(pine, OnDevice(merged(pine)), 1e-3, "pine");
  disagreement(pine, OnDevice(merged(pine)), 1e-4, "pine");
}

}  // namespace dapple::oracle
