// Compares strands with Embree's round linear curves, ray by ray: transmittances and first hits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "oracle/oracle_rays.hpp"
#include "oracle/oracle_scenes.hpp"
#include "support/scenes/curly_strands.hpp"

namespace dapple::oracle {
namespace {

using scene_test::curly_strands;
using scene_test::strand_scene;

constexpr std::size_t kChecked = 30'000;

/// Our segments are cones that are joined at planes, with end points rounded to about a thousandth
/// of a radius; Embree's are spheres swept along lines. A ray that grazes a strand, or the outside
/// of a bend, may hit one and not the other. 0.5 % of the rays may differ, and the mean by 0.003.
void expect_equal(const Scene& loaded, const char* label) {
  const Scene scene = merged(loaded);
  const OnDevice prepared(scene);
  std::vector<Segment> segments = random_segments(loaded, 1);
  segments.resize(kChecked);
  const EmbreeOracle oracle(loaded);
  const auto ours =
      trace(prepared.device, prepared.uploaded, device_rays(segments, 0), Estimator::exact);
  double mean = 0, level = 0;
  std::size_t different = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const double theirs = oracle.transmittance(segments[i]);
    level += theirs / kChecked;
    mean += (ours[i].transmittance - theirs) / kChecked;
    different += std::fabs(ours[i].transmittance - theirs) > 2e-3;
  }
  std::printf("%s: %zu of %zu rays differ by more than 0.002; mean %.4f, difference %+.1e\n", label,
              different, kChecked, level, mean);
  EXPECT_LE(different, kChecked / 200) << label;
  EXPECT_LE(std::fabs(mean), 0.003) << label;
}

TEST(OracleStrands, CurlsTransmitAsInEmbree) {
  expect_equal(strand_scene(curly_strands({}), 0.3f), "curls");
}

TEST(OracleStrands, PointedStrandsTransmitAsInEmbree) {
  expect_equal(strand_scene(curly_strands({.tip = 0, .turns = 3}), 0.3f), "pointed");
}

TEST(OracleStrands, OpaqueStrandsOccludeAsInEmbree) {
  expect_equal(strand_scene(curly_strands({.strands = 2000, .radius = 0.001f}), 1), "opaque");
}

TEST(OracleStrands, StrandsAmongTrianglesTransmitAsInEmbree) {
  Scene scene = make_procedural("scene:cloud?leaves=2000&opacity=0.5");
  scene.materials.push_back(scene_test::material_of(0.3f));
  const auto hair = static_cast<std::uint32_t>(scene.materials.size() - 1);
  const Mesh mesh = curly_strands({}, hair);
  for (const float turn : {0.0f, 1.0f}) {
    M44f placement;
    placement.rotate(V3f(turn, turn, 0));
    placement.scale(V3f(1 + turn));
    placement.translate(V3f(0, turn, 0));
    scene_test::place(scene, mesh, placement);
  }
  expect_equal(scene, "curls in a cloud");
}

TEST(OracleStrands, RealHairTransmitsAsInEmbree) {
  const std::string path = shared_scene("mohawk.hair");
  DAPPLE_SKIP_WITHOUT(path);
  // Enlarged 100 times, in metres: in scenes of millimetres Embree's curves lose precision.
  Mesh mesh = load_scene(path).meshes.at(0);
  for (V3f& position : mesh.positions) position *= 100.0f;
  std::fill(mesh.radii.begin(), mesh.radii.end(), 0.08f);
  Scene scene = strand_scene(std::move(mesh), 0.3f);
  merge_single_instances(scene);
  expect_equal(scene, "mohawk");
}

/// Compares positions and normals of the closest hits on opaque strands.
TEST(OracleStrands, ClosestHitsAgreeWithEmbree) {
  constexpr float kRadius = 0.002f;
  const Scene scene = strand_scene(curly_strands({.radius = kRadius, .tip = 0.5f}), 1);
  const OnDevice prepared(scene);
  std::vector<Segment> segments = random_segments(scene, 2);
  segments.resize(kChecked);
  const EmbreeOracle oracle(scene);
  const auto ours = closest_hits(prepared.device, prepared.uploaded, device_rays(segments, 0));
  std::size_t hits = 0, different = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto theirs = oracle.first_hit(segments[i], i);
    if (!theirs || ours[i].t < 0) {
      different += theirs.has_value() != (ours[i].t >= 0);
      continue;
    }
    ++hits;
    V3d position, normal;
    for (int k = 0; k < 3; ++k) {
      position[k] = ours[i].position[k];
      normal[k] = ours[i].normal[k];
    }
    different +=
        (position - theirs->position).length() > 0.1 * kRadius || normal.dot(theirs->normal) < 0.98;
  }
  std::printf("first hits: %zu of %zu differ\n", different, hits);
  EXPECT_GT(hits, kChecked / 4);
  EXPECT_LE(different, kChecked / 200);
}

/// Pictures are traced in packets. A ray from the camera to the position in each pixel must hit
/// that position first.
TEST(OracleStrands, CameraHitsAgreeWithEmbree) {
  constexpr float kRadius = 0.004f;
  Scene scene = strand_scene(curly_strands({.strands = 200, .radius = kRadius}), 1);
  const V3f eye(0, 0.5f, 3);
  scene.cameras.push_back(look_at(eye, {0, 0, 0}, {0, 1, 0}, 0.8f));
  const EmbreeOracle oracle(scene);
  RenderOptions options;
  options.width = options.height = 128;
  options.spp = 1;
  options.ao = options.light = false;
  const Film film = render(scene, options).film;
  std::size_t hits = 0, different = 0;
  for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
    if (film.find("A")->pixels[p] == 0) continue;
    ++hits;
    const V3f place(film.find("P.X")->pixels[p], film.find("P.Y")->pixels[p],
                    film.find("P.Z")->pixels[p]);
    const auto hit = oracle.first_hit({eye, (place - eye).normalized()}, p);
    different += !hit || (hit->position - V3d(place)).length() > 0.25 * kRadius;
  }
  EXPECT_GT(hits, 1000u);
  EXPECT_LE(different, hits / 50);  // grazing rays
}

}  // namespace
}  // namespace dapple::oracle
