// Strands: every segment is in one lane and inside of its boxes, and a ray that crosses a strand
// counts it once, also where segments join. Prefiltered rays without a footprint equal exact rays;
// with one, the mean opacity is kept.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bvh/build/object_bvh.hpp"
#include "bvh/build/quantize_boxes.hpp"
#include "bvh/storage/segment_block.hpp"
#include "support/scenes/curly_strands.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr float kRadius = 0.01f;

/// A strand through these points.
Mesh strand(const std::vector<V3f>& points, float radius = kRadius) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    mesh.positions.push_back(points[i]);
    mesh.radii.push_back(radius);
    if (i == 0) continue;
    mesh.indices.insert(mesh.indices.end(), {i - 1, i});
    mesh.materials.push_back(0);
  }
  return mesh;
}

/// Rays from a square in the plane z = 1 towards -Z, from a grid of count x count points. `side` is
/// the square's size; `slant` is added to the direction.
std::vector<Ray> rays_down(float side, int count, const V3f& slant = V3f(0.0f)) {
  std::vector<Ray> rays;
  for (int i = 0; i < count * count; ++i) {
    const auto place = [&](int k) {
      return (static_cast<float>(k) + 0.5f) / static_cast<float>(count) - 0.5f;
    };
    rays.push_back(make_ray(V3f(place(i % count), place(i / count), 0) * side + V3f(0, 0, 1),
                            V3f(0, 0, -1) + slant));
  }
  return rays;
}

TEST(SegmentBlock, DecodedSegmentsAreThoseOfTheMeshToASmallPartOfTheirRadius) {
  const Mesh mesh = curly_strands({.strands = 20, .radius = 0.002f, .tip = 0.3f});
  const StrandJoints joints(mesh);
  for (std::uint32_t s = 0; s + 8 <= mesh.primitive_count(); s += 8) {
    std::vector<StrandSegment> segments;
    for (std::uint32_t i = 0; i < 8; ++i) segments.push_back(joints.segment(mesh, s + i));
    for (StrandSegment& segment : segments) segment.opacity = 0.3f;
    const SegmentBlock block = pack_segments(segments);
    for (unsigned lane = 0; lane < 8; ++lane) {
      const StrandSegment decoded = unpack_segment(block, lane);
      for (int end = 0; end < 2; ++end) {
        // At most half a step. A step is at most 2 / 65535 of the block's size, which is less than
        // a strand's length.
        EXPECT_LT((decoded.point[end] - segments[lane].point[end]).length(), 2e-5f);
        // Half a step of the square root of the greatest one's share.
        const float radius = segments[lane].radius[end];
        EXPECT_NEAR(decoded.radius[end], radius, std::sqrt(1.01f * radius * 0.002f) / 255);
        EXPECT_GT(decoded.plane[end].normalized().dot(segments[lane].plane[end].normalized()),
                  0.9999f);
        EXPECT_EQ(decoded.cap[end], segments[lane].cap[end]);
      }
      EXPECT_FLOAT_EQ(decoded.opacity, 0.3f);
    }
  }
}

/// Returns the bounds of the segments below node `index`. Checks that each child box contains its
/// segments, and counts the segments.
Box3f walk(const ObjectBvh& object, std::uint32_t index, std::size_t& count) {
  const BvhNode& node = object.nodes[index];
  EXPECT_TRUE(node.prim_base & DAPPLE_SEGMENTS);
  Box3f box;
  std::uint32_t inner = 0;
  for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    if (node.lower[0][slot] > node.upper[0][slot]) continue;
    Box3f child;
    if (node.inner_mask >> slot & 1) child = walk(object, node.child_base + inner++, count);
    for (std::uint32_t i = bvh_leaf_begin(&node, slot); i < bvh_leaf_end(node.leaf_end, slot);
         ++i, ++count) {
      const SegmentBlock& block = object.segments[bvh_block_index(bvh_block(node.prim_base, i))];
      child.extendBy(bounds(unpack_segment(block, i % 8)));
    }
    const Box3f grown = child_box(node, slot);
    EXPECT_TRUE(grown.intersects(child.min) && grown.intersects(child.max));
    box.extendBy(child);
  }
  return box;
}

TEST(Strands, EverySegmentIsInOneLaneInsideItsBoxes) {
  const Scene scene = strand_scene(curly_strands({}), 0.3f);
  const ObjectBvh object = build_object(scene, OpaqueTexels(scene), scene.meshes[0]).object;
  std::size_t count = 0;
  EXPECT_EQ(walk(object, 0, count), object.box);
  EXPECT_EQ(count, scene.meshes[0].primitive_count());
  EXPECT_TRUE(object.blocks.empty());
}

TEST(Strands, TakeAtMostSixtyBytesASegment) {
  const SceneBvh bvh =
      build_bvh(strand_scene(curly_strands({.strands = 5000, .radius = 0.0005f}), 0.3f));
  const std::size_t bytes =
      bvh.nodes.size() * sizeof(BvhNode) + bvh.segments.size() * sizeof(SegmentBlock);
  EXPECT_EQ(bvh.statistics.segments, 80'000u);
  EXPECT_LE(static_cast<double>(bytes) / 80'000, 60.0);
}

TEST(Strands, OccludeWhatACapsuleOccludes) {
  // A straight strand of three segments occludes the area of a capsule, 2 r l + pi r^2: its joints
  // must not add anything.
  const SceneOnDevice scene(
      strand_scene(strand({{-0.2f, 0, 0}, {-0.05f, 0, 0}, {0.1f, 0, 0}, {0.2f, 0, 0}}), 0.3f));
  const double occluded = 2 * kRadius * 0.4 + kPi * kRadius * kRadius;
  const double mean = mean_transmittance(scene.trace(rays_down(0.5f, 400), Estimator::exact));
  EXPECT_NEAR((1 - mean) * 0.25, 0.3 * occluded, 0.3 * occluded * 2e-3);
  // Seen end-on, a strand is a disk.
  const SceneOnDevice upright(strand_scene(strand({{0, 0, -0.2f}, {0, 0, 0.3f}}), 0.3f));
  const double disk = kPi * kRadius * kRadius, area = 9e-4;
  const double left = mean_transmittance(upright.trace(rays_down(0.03f, 200), Estimator::exact));
  EXPECT_NEAR((1 - left) * area, 0.3 * disk, 0.3 * disk * 5e-3);
}

// Rays within the angle of a tapering strand's tip: they see the half sphere at its thick end and
// the disk behind that, pi r^2 (1 + cos) / 2. Many of them miss the cone.
TEST(Strands, AreSeenFromTheirThickEndAsTheHalfSphereThere) {
  constexpr float kThick = 0.1f, kSlant = 0.2f, kSide = 0.8f;
  Mesh cone = strand({{0, 0, 0.1f}, {0, 0, -0.1f}});
  cone.radii = {kThick, 0};
  const SceneOnDevice scene(strand_scene(cone, 0.3f));
  const double cosine = 1 / std::hypot(1.0, double{kSlant});
  const double seen = kPi * kThick * kThick * (1 + cosine) / 2;
  const double mean =
      mean_transmittance(scene.trace(rays_down(kSide, 400, V3f(kSlant, 0, 0)), Estimator::exact));
  EXPECT_NEAR((1 - mean) * kSide * kSide * cosine, 0.3 * seen, 0.3 * seen * 5e-3);
}

// What hides the light from one side hides it from the other.
TEST(Strands, AreSeenFromTheirThinEndAsFromTheThickOne) {
  constexpr float kThick = 0.1f;
  for (const float thin : {0.09f, 0.05f, 0.0f}) {
    for (const float slant : {0.0f, 0.1f, 0.2f}) {
      Mesh cone = strand({{0, 0, 0.2f}, {0, 0, -0.2f}});
      cone.radii = {kThick, thin};
      Mesh turned = cone;
      std::swap(turned.radii[0], turned.radii[1]);
      const auto seen = [&](const Mesh& mesh, float x) {
        const SceneOnDevice scene(strand_scene(mesh, 0.5f));
        return 1 - mean_transmittance(
                       scene.trace(rays_down(0.8f, 400, V3f(x, 0, 0)), Estimator::exact));
      };
      const double from_thick = seen(cone, slant), from_thin = seen(turned, -slant);
      EXPECT_NEAR(from_thin, from_thick, 0.01 * from_thick) << thin << ", " << slant;
    }
  }
}

TEST(Strands, ShortSegmentsDoNotVanishBesideALongOne) {
  Mesh mesh = strand({{0, 0.3f, 0}, {400, 0.3f, 0}}, 0.01f);
  mesh.positions.insert(mesh.positions.end(), {{0.2f, 0, 0}, {0.203f, 0, 0}});
  mesh.radii.insert(mesh.radii.end(), {0.05f, 0.05f});
  mesh.indices.insert(mesh.indices.end(), {2, 3});
  mesh.materials.push_back(0);
  const SceneOnDevice scene(strand_scene(mesh, 0.5f));
  const auto found = scene.trace({make_ray({0.2f, 0.02f, 1}, {0, 0, -1})}, Estimator::exact);
  EXPECT_NEAR(found[0].transmittance, 0.5, 1e-5);
}

// All are in one block, whose codes of radii and opacities are those of the greatest.
TEST(Strands, ThinAndFaintOnesDoNotVanishBesideThickAndOpaqueOnes) {
  constexpr float kThin = 3e-4f, kFaint = 0.01f;
  Mesh mesh = strand({{-0.2f, 0.3f, 0}, {0.2f, 0.3f, 0}}, 0.1f);
  mesh.positions.insert(mesh.positions.end(), {{-0.2f, 0, 0}, {0.2f, 0, 0}});
  mesh.radii.insert(mesh.radii.end(), {kThin, kThin});
  mesh.indices.insert(mesh.indices.end(), {2, 3});
  mesh.materials.push_back(0);
  mesh.vertex_alpha = {1, 1, kFaint, kFaint};
  Scene scene = strand_scene(mesh, 1);
  scene.materials[0].uses_vertex_alpha = true;
  const SceneOnDevice on_device(std::move(scene));
  const std::vector<Ray> rays{make_ray({0, 0.9f * kThin, 1}, {0, 0, -1}),
                              make_ray({0, 1.1f * kThin, 1}, {0, 0, -1})};
  const auto found = on_device.trace(rays, Estimator::exact);
  EXPECT_NEAR(found[0].transmittance, 1 - kFaint, 0.05f * kFaint);
  EXPECT_EQ(found[1].transmittance, 1);
}

TEST(Strands, ASegmentHasTheMeanOpacityOfItsEnds) {
  Scene scene = strand_scene(strand({{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}), 0.5f);
  scene.materials[0].uses_vertex_alpha = true;
  scene.meshes[0].vertex_alpha = {0.2f, 0.6f, 1};
  const SceneOnDevice on_device(std::move(scene));
  const auto found = on_device.trace(
      {make_ray({-0.5f, 0, 1}, {0, 0, -1}), make_ray({0.5f, 0, 1}, {0, 0, -1})}, Estimator::exact);
  // Square roots of opacities are 255ths of that of the largest one in their block.
  EXPECT_NEAR(found[0].transmittance, 1 - 0.5 * 0.4, std::sqrt(0.5 * 0.4 * 0.5 * 0.8) / 255);
  EXPECT_NEAR(found[1].transmittance, 1 - 0.5 * 0.8, 1e-5);
}

TEST(Strands, AreCountedOnceWhereSegmentsJoin) {
  // Strands with a bend of up to a right angle, in the plane z = 0 and out of it.
  for (const V3f& last : {V3f(0.1f, 0, 0), V3f(0.1f, 0.04f, 0), V3f(0.1f, 0.1f, 0),
                          V3f(0.005f, 0.1f, 0), V3f(0.1f, 0, 0.05f), V3f(0.1f, 0.02f, -0.03f)}) {
    const SceneOnDevice scene(strand_scene(strand({{-0.1f, 0, 0}, {0, 0, 0}, last}), 0.5f));
    const auto found = scene.trace(rays_down(0.05f, 300, {0.01f, 0.02f, 0}), Estimator::exact);
    std::size_t twice = 0, once = 0;
    for (const Occlusion& one : found) {
      twice += one.transmittance < 0.49f;
      once += one.transmittance < 0.51f;
    }
    // Of 90,000 rays only a few may count the strand twice, because end points and planes are
    // rounded.
    EXPECT_LE(twice, 20u) << last;
    EXPECT_GT(once, 20'000u) << last;
  }
}

TEST(Strands, OutsideOfABendThereIsNoGap) {
  const V3f last(0.1f, 0.06f, 0);
  const SceneOnDevice scene(strand_scene(strand({{-0.1f, 0, 0}, {0, 0, 0}, last}), 1));
  // Points on the outer side of the bend, in the sector between the ends of the two segments.
  const V3f outward = (V3f(-1, 0, 0) + last.normalized()).normalized() * -1.0f;
  for (int i = 0; i < 100; ++i) {
    const V3f at = outward * (kRadius * 0.0099f * static_cast<float>(i));
    const auto found = scene.trace({make_ray(at + V3f(0, 0, 1), {0, 0, -1})}, Estimator::exact);
    EXPECT_EQ(found[0].transmittance, 0.0f) << i;
  }
}

TEST(Strands, DontOccludeTheirOwnSurface) {
  const SceneOnDevice scene(
      strand_scene(strand({{-0.2f, 0, 0}, {-0.05f, 0.01f, 0}, {0.1f, 0, 0}, {0.2f, 0, 0.01f}}), 1));
  std::vector<SurfacePoint> points =
      closest_hits(device(), scene.uploaded, rays_through(scene.bvh.bounds, 2000, 5, 0, 3));
  Points random(4);
  std::vector<Ray> rays;
  for (const SurfacePoint& point : points) {
    if (point.t < 0) continue;
    const V3f position(point.position[0], point.position[1], point.position[2]);
    const V3f normal(point.normal[0], point.normal[1], point.normal[2]);
    for (int i = 0; i < 8; ++i) {
      const V3f direction = (random.on_sphere() * 0.999f + normal).normalized();
      rays.push_back(make_ray(position + normal * point.offset, direction));
    }
  }
  ASSERT_GT(rays.size(), 4000u);
  std::size_t occluded = 0;
  for (const Occlusion& one : scene.trace(rays, Estimator::exact))
    occluded += one.transmittance < 1;
  // The strand is not quite straight: a few rays graze the next segment.
  EXPECT_LT(occluded, rays.size() / 50);
}

TEST(Strands, PrefilteredWithoutAFootprintIsExact) {
  const SceneOnDevice scene(strand_scene(curly_strands({}), 0.3f));
  const auto rays = rays_through(scene.bvh.bounds, 4000, 3, 0.05f, 2);
  const auto exact = scene.trace(rays, Estimator::exact);
  const auto prefiltered = scene.trace(rays, Estimator::prefiltered, 0);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(exact[i].transmittance, prefiltered[i].transmittance);
  }
}

TEST(Strands, PrefilteredKeepsTheMeanOpacityOfTheWhole) {
  for (const float opacity : {0.3f, 1.0f}) {
    const SceneOnDevice scene(
        strand_scene(curly_strands({.strands = 2000, .radius = 0.001f}), opacity));
    const auto rays = rays_across(scene.bvh.bounds, 20'000, 0.002f, 5);
    const double exact = mean_transmittance(scene.trace(rays, Estimator::exact));
    for (const float footprint : {0.25f, 1.0f, 4.0f}) {
      const double found = mean_transmittance(scene.trace(rays, Estimator::prefiltered, footprint));
      EXPECT_NEAR(found, exact, 0.01) << opacity << ", footprint " << footprint;
    }
  }
}

/// Compares the mean ambient occlusion at points on strands.
TEST(Strands, PrefilteredAmbientOcclusionIsNearTheExact) {
  const SceneOnDevice scene(strand_scene(curly_strands({.strands = 3000, .radius = 0.001f}), 0.3f));
  const auto hits =
      closest_hits(device(), scene.uploaded, rays_through(scene.bvh.bounds, 600, 3, 0, 8));
  std::vector<V3f> points, normals;
  for (const SurfacePoint& hit : hits) {
    if (hit.t < 0) continue;
    points.emplace_back(hit.position[0], hit.position[1], hit.position[2]);
    normals.emplace_back(hit.normal[0], hit.normal[1], hit.normal[2]);
  }
  ASSERT_GT(points.size(), 100u);
  const auto mean = [&](Estimator estimator) {
    OcclusionOptions options;
    options.rays = 64;
    options.estimator = estimator;
    double sum = 0;
    for (const float ao : occlusion(device(), scene.uploaded, points, normals, options)) sum += ao;
    return sum / static_cast<double>(points.size());
  };
  EXPECT_NEAR(mean(Estimator::prefiltered), mean(Estimator::exact), 0.01);
}

TEST(Strands, PlacedLargerAreAsThickAsTheyAreLong) {
  Scene baked = strand_scene(curly_strands({.strands = 100}), 0.5f), placed = baked;
  M44f turn;
  turn.rotate(V3f(0.3f, 0.2f, 0.5f));
  turn.scale(V3f(2, 2, 2));
  turn.translate(V3f(0.1f, 0.2f, 0.3f));
  placed.instances[0].to_world = baked.instances[0].to_world = turn;
  merge_single_instances(baked);
  EXPECT_EQ(baked.instances[0].to_world, M44f());
  const SceneOnDevice one(baked), other(placed);
  const auto rays = rays_through(one.bvh.bounds, 20'000, 5, 0, 2);
  const auto a = one.trace(rays, Estimator::exact), b = other.trace(rays, Estimator::exact);
  std::size_t different = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    different += std::fabs(a[i].transmittance - b[i].transmittance) > 1e-4f;
  }
  EXPECT_LE(different, 40u);
}

TEST(Strands, LengthAndRadiusOfFileOrderDontMatter) {
  // The same strand, with its segments in the opposite order and with their ends exchanged.
  Mesh mesh = strand({{-0.1f, 0, 0}, {0, 0, 0}, {0.1f, 0.05f, 0}}), turned = mesh;
  turned.indices = {2, 1, 0, 1};
  const SceneOnDevice one(strand_scene(mesh, 0.5f)), other(strand_scene(turned, 0.5f));
  const auto rays = rays_down(0.1f, 200);
  EXPECT_NEAR(mean_transmittance(one.trace(rays, Estimator::exact)),
              mean_transmittance(other.trace(rays, Estimator::exact)), 1e-4);
}

}  // namespace
}  // namespace dapple
