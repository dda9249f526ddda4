// Compares the exact estimator with Embree, ray by ray.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "oracle/embree_oracle.hpp"
#include "oracle/oracle_rays.hpp"
#include "oracle/oracle_scenes.hpp"

namespace dapple::oracle {
namespace {

constexpr double kTolerance = 1e-4;
/// A pine's card spans some 600 texels, and at a needle's edge alpha goes from 0 to 1 within one
/// texel. So a rounding of 1e-6 in u and v changes the opacity by 6e-4.
constexpr double kTextureTolerance = 1e-3;

/// Whether roundings of a kernel can explain `ours`: 256 rays near `segment` have transmittances
/// whose range contains `ours`. They are 1e-6 of the largest number in the ray away, about 16
/// roundings of 2^-24 each.
bool is_a_neighbours(const EmbreeOracle& oracle, const Segment& segment, double ours,
                     double tolerance) {
  constexpr double kRounding = 1e-6;
  Random random(3);
  float largest = std::isfinite(segment.t_max) ? segment.t_max : 0;
  for (int k = 0; k < 3; ++k) largest = std::max(largest, std::fabs(segment.origin[k]));
  double min = 1, max = 0;
  for (int i = 0; i < 256; ++i) {
    Segment neighbour = segment;
    neighbour.origin = V3f(V3d(segment.origin) + random.direction() * (kRounding * largest));
    neighbour.t_max *= static_cast<float>(1 + kRounding * random.between(-1, 1));
    const double transmittance = oracle.transmittance(neighbour);
    min = std::min(min, transmittance);
    max = std::max(max, transmittance);
  }
  return ours >= min - tolerance && ours <= max + tolerance;
}

struct Disagreement {
  std::size_t rays = 0;         ///< number of rays that differ by more than the tolerance
  std::size_t unexplained = 0;  ///< number of those that is_a_neighbours() does not explain
  double mean = 0;              ///< mean of the signed differences of all rays
  double grey = 0;              ///< share of rays with a transmittance in (0, 1)
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
    found.mean += difference / count;
    found.grey += theirs[i] > 0 && theirs[i] < 1 ? 1 / count : 0;
    if (std::fabs(difference) <= tolerance) continue;
    ++found.rays;
    found.unexplained += !is_a_neighbours(oracle, segments[i], ours[i].transmittance, tolerance);
  }
  return found;
}

/// Embree gets the scene `loaded`, the device gets it as `prepared`.
///
/// Kernels compute in float and test triangles in another way than Embree, so a ray within rounding
/// of an edge may pass it on either side. Rounding is 1e-6 of some metres and leaves are a few
/// centimetres wide, so the uncertain border is 1e-4 to 1e-3 of a leaf. 50 of 100,000 rays may
/// differ. For all but three of them, neighbouring rays must confirm that the ray is near an edge:
/// on an edge that two triangles share, a ray may hit both or neither in the kernels, while each of
/// its neighbours hits one.
void expect_equal(const Scene& loaded, const OnDevice& prepared, double tolerance,
                  const char* label) {
  const std::vector<Segment> segments = random_segments(loaded, 1);
  const Disagreement found =
      compare(EmbreeOracle(loaded), segments,
              trace(prepared.device, prepared.uploaded, device_rays(segments, 0), Estimator::exact),
              tolerance);
  std::printf(
      "%s: %zu of %zu rays differ by more than %g, %zu unexplained; mean difference %.1e; "
      "%.0f %% grey\n",
      label, found.rays, kRays, tolerance, found.unexplained, found.mean, 100 * found.grey);
  EXPECT_LE(found.rays, 50u) << label;
  EXPECT_LE(found.unexplained, 3u) << label;
  // Errors at edges have both signs: a tenth of the mean that 50 completely wrong rays would give.
  EXPECT_LE(std::fabs(found.mean), 5e-5) << label;
}

/// Adds a material for every combination of wrap modes, filter and alpha mode, with and without
/// texture and vertex alpha. The sides of the small images are no powers of two.
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

/// Random triangles in a cube of side 2 around the origin, with all materials of the scene.
Mesh random_triangles(const Scene& scene, Random& random) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 342; ++i) {
    const V3d centre(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    for (std::uint32_t k = 0; k < 3; ++k) {
      mesh.indices.push_back(3 * i + k);
      mesh.positions.emplace_back(centre + random.direction() * 0.12);
      mesh.uvs.emplace_back(random.between(-3, 3), random.between(-3, 3));
      mesh.vertex_alpha.push_back(static_cast<float>(random.real()));
    }
    mesh.materials.push_back(i % static_cast<std::uint32_t>(scene.materials.size()));
  }
  return mesh;
}

/// Four instances of the random triangles: unchanged, mirrored, stretched and sheared.
Scene soup_of_every_material() {
  Random random(2);
  Scene scene;
  scene.source = "soup";
  add_every_material(scene, random);
  scene.meshes.push_back(random_triangles(scene, random));
  const M44f transforms[] = {
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
      {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1},
      {0, 3, 0, 0, -0.5f, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 1},
      {1, 0, 0, 0, 0.7f, 0.5f, 0.2f, 0, 0, -0.4f, 1, 0, 1, 1, -1, 1},
  };
  for (const M44f& to_world : transforms) scene.instances.push_back({0, to_world, -1});
  return scene;
}

}  // namespace

TEST(Oracle, GreySheetsMultiply) {
  const EmbreeOracle oracle(load_scene("scene:greys"));
  EXPECT_NEAR(oracle.transmittance({V3f(0.3f, 5, 0.2f), V3f(0, -1, 0), 4.99f}), 0.375, 1e-6);
}

TEST(OracleRays, EveryMaterialInEveryPlacementTransmitsAsInEmbree) {
  const Scene scene = soup_of_every_material();
  expect_equal(scene, OnDevice(scene), kTextureTolerance, "soup");
}

TEST(OracleRays, ProceduralPlantsTransmitAsInEmbree) {
  const Scene tree = load_scene("scene:tree?leaves=3000");
  expect_equal(tree, OnDevice(merged(tree)), kTolerance, "tree");
  const Scene forest = load_scene("scene:forest?trees=9&leaves=500");
  const OnDevice instanced(merged(forest));
  EXPECT_TRUE(instanced.bvh.has_top);
  expect_equal(forest, instanced, kTolerance, "forest");
}

TEST(OracleRays, TheSaplingTransmitsAsInEmbree) {
  DAPPLE_SKIP_WITHOUT(shared_scene("sapling_100k.glb"));
  const Scene sapling = load_sapling();
  expect_equal(sapling, OnDevice(merged(sapling)), kTolerance, "sapling");
}

TEST(OracleRays, TheTexturedPineTransmitsAsInEmbree) {
  DAPPLE_SKIP_WITHOUT(shared_scene("smallpine"));
  const Scene pine = load_pine();
  expect_equal(pine, OnDevice(merged(pine)), kTextureTolerance, "pine");
}

}  // namespace dapple::oracle
