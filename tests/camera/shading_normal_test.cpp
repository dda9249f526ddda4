// Shading normals: how they are packed, the closed form of a tilted surface, flat surfaces bit for
// bit, the same through instances and refits. facets_test.cpp has smooth surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "dapple/render.hpp"
#include "device/upload/normal_upload.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/shading_pictures.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

using namespace scene_test;
using test::options_of;
using test::scene_of;
using test::small_sun;
using test::smooth_sphere;
using test::three;

/// A square of side 2 around the origin that faces +Z, whose normals are `normal`.
Mesh square(const V3f& normal) {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, normal.normalized());
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

TEST(CornerNormals, OnlyBlocksWithSmoothTrianglesStoreNormals) {
  Mesh mesh = square({0, 0, 1});
  for (std::uint32_t i = 1; i < 200; ++i) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      mesh.positions.push_back(mesh.positions[k] + V3f(3.0f * static_cast<float>(i), 0, 0));
      mesh.normals.push_back(V3f(0, 0, 1));
    }
    for (std::uint32_t k = 0; k < 6; ++k) mesh.indices.push_back(4 * i + mesh.indices[k]);
  }
  const auto packed = [&] {
    const Scene scene = scene_of(mesh);
    const SceneBvh bvh = build_bvh(scene);
    return std::pair(pack_normals(scene, bvh).size(), (bvh.blocks.size() + 15) / 16);
  };
  EXPECT_EQ(packed().first, 0u) << "all are flat";
  mesh.normals[400] = V3f(0, 1, 1).normalized();  // of one square
  const auto [normals, table] = packed();
  EXPECT_GE(normals, DAPPLE_NORMAL_GROUP * (table + 1));
  EXPECT_LE(normals, DAPPLE_NORMAL_GROUP * (table + 2));
}

TEST(CornerNormals, FlatTrianglesHaveAnEmptyTableWhereOneIsAskedFor) {
  const Scene scene = scene_of(square({0, 0, 1}));
  const std::vector<CornerNormals> kept = pack_normals(scene, build_bvh(scene), true);
  ASSERT_EQ(kept.size(), DAPPLE_NORMAL_GROUP);
  for (const CornerNormals& two_blocks : kept)
    EXPECT_EQ(two_blocks.words[0] | two_blocks.words[1], 0u);
}

TEST(CornerNormals, AnglesBetweenNormalsAndTheirCodesAreBelowASixthOfADegree) {
  Points points(3);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const std::array<V3f, 3> given{points.on_sphere(), points.on_sphere(), points.on_sphere()};
    const CornerNormals packed = pack_corner_normals(given);
    for (uint corner = 0; corner < 3; ++corner) {
      V3f decoded;
      corner_vector(corner_code(packed, corner), &decoded.x);
      const V3d a(decoded), b(given[corner]);
      worst = std::max(worst, std::atan2(a.cross(b).length(), a.dot(b)));
    }
  }
  EXPECT_LE(worst * 180 / kPi, 0.17);
}

TEST(CornerNormals, DirectionCodesAreExactToAHundredthOfADegree) {
  Points points(4);
  for (int i = 0; i < 10000; ++i) {
    const V3f given = points.on_sphere();
    const uint code = direction_code(&given.x);
    ASSERT_NE(code, 0u);
    V3f decoded;
    octahedral_vector(static_cast<float>((code & 65535u) - 1) / 32767 - 1,
                      static_cast<float>((code >> 16) - 1) / 32767 - 1, &decoded.x);
    const V3d a(decoded), b(given);
    EXPECT_LE(std::atan2(a.cross(b).length(), a.dot(b)) * 180 / kPi, 0.01);
  }
}

/// Those of lane 0 of block 0.
CornerNormals first_normals(const std::vector<CornerNormals>& packed) {
  return packed.at(DAPPLE_NORMAL_GROUP * packed.at(0).words[0]);
}

TEST(PackNormals, NormalsOfTheFaceTakeNoMemoryAndOthersAreOnItsSide) {
  const auto pack = [](const V3f& normal) {
    const Scene scene = scene_of(square(normal));
    return pack_normals(scene, build_bvh(scene));
  };
  EXPECT_TRUE(pack({0, 0, 1}).empty());
  EXPECT_TRUE(pack({0, 0, -1}).empty()) << "wound the other way";
  EXPECT_TRUE(pack({0, 0.0005f, 1}).empty()) << "rounding";
  for (const float side : {1.0f, -1.0f}) {
    const std::vector<CornerNormals> packed = pack(V3f(0, 0.5f, 1) * side);
    ASSERT_EQ(packed.size(), 2 * DAPPLE_NORMAL_GROUP);
    V3f decoded;
    corner_vector(corner_code(first_normals(packed), 1), &decoded.x);
    EXPECT_LE((decoded.normalized() - V3f(0, 0.5f, 1).normalized()).length(), 0.002f);
  }
  Scene scene = scene_of(square({0, 0.5f, 1}));
  scene.meshes[0].normals[0] = V3f(0, 0, 0);
  V3f decoded;
  corner_vector(corner_code(first_normals(pack_normals(scene, build_bvh(scene))), 0), &decoded.x);
  EXPECT_LE((decoded.normalized() - V3f(0, 0, 1)).length(), 0.002f) << "that of the face";
}

double mean_of(const Film& film, const char* channel) {
  const std::vector<float>& pixels = film.find(channel)->pixels;
  return std::accumulate(pixels.begin(), pixels.end(), 0.0) / static_cast<double>(pixels.size());
}

// A hemisphere that leans by theta against a plane sees (1 + cos theta) / 2 above it.
TEST(ShadingNormal, ATiltedHemisphereIsHiddenBelowThePlane) {
  for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
    const double theta = degrees * kPi / 180;
    Scene scene = scene_of(
        square(V3f(0, static_cast<float>(std::sin(theta)), static_cast<float>(std::cos(theta)))));
    // From above the surface by its leaning normal, from below, and from across.
    scene.lights = {small_sun({0, 1, 0.05f}), small_sun({0, 1, -0.05f}), small_sun({0, 0, 1})};
    RenderOptions options = options_of(Normals::shading);
    options.look = LookAt{V3f(0, 0, 100), V3f(0, 0, 0), V3f(0, 1, 0)};
    options.fov_degrees = 1;  // so that no normal faces away from the viewer
    options.crop = PixelRect{30, 20, 49, 39};
    options.spp = 256;
    const Film film = render(scene, options).film;
    const auto mean = [&](const char* channel) { return mean_of(film, channel); };
    ASSERT_EQ(mean("A"), 1) << "the square fills the picture";
    EXPECT_NEAR(mean("ao.R"), (1 + std::cos(theta)) / 2, 0.002) << degrees << " degrees";
    const double length = std::sqrt(1 + 0.05 * 0.05);
    EXPECT_NEAR(mean("light.sun.R"), (std::sin(theta) + 0.05 * std::cos(theta)) / length, 0.002);
    EXPECT_EQ(mean("light.sun_2.R"), 0) << "below the surface";
    EXPECT_NEAR(mean("light.sun_3.R"), std::cos(theta), 0.002);
  }
}

// Normals of foliage are often those of a sphere around it. Of a card whose back is seen they are
// turned inwards; they turn across the card until they face the viewer as much.
TEST(ShadingNormal, NoNormalThatIsSeenFacesAway) {
  for (const double degrees : {40.0, 70.0, 88.0}) {
    const double lean = degrees * kPi / 180;
    const Scene scene = scene_of(
        square(V3f(0, static_cast<float>(std::sin(lean)), static_cast<float>(std::cos(lean)))));
    RenderOptions options = options_of(Normals::shading);
    options.look = LookAt{V3f(0, -3, 1), V3f(0, 0, 0), V3f(0, 0, 1)};
    options.fov_degrees = 2;
    const Film film = render(scene, options).film;
    const auto mean = [&](const char* channel) { return mean_of(film, channel); };
    ASSERT_EQ(mean("A"), 1) << "the square fills the picture";
    const V3d view = V3d(0, -3, 1).normalized();
    const V3d given(0, std::sin(lean), std::cos(lean));
    const V3d leaning(0, std::sin(lean), 0);
    const double turn = std::max(0.0, 2 * given.dot(view) / leaning.dot(view));
    const V3d expected = (given - leaning * turn).normalized();
    const V3d found(mean("N.X"), mean("N.Y"), mean("N.Z"));
    EXPECT_LT((found - expected).length(), 0.01) << degrees << " degrees";
    EXPECT_GE(found.dot(view), -0.01) << degrees << " degrees";
  }
}

// From the rim of a lens rays see the side of a card that its middle does not see. Cards in a plane
// that contains the axis of the lens, or almost: half of the rays see each side.
TEST(ShadingNormal, FacesTheRayThatSawItNotTheMiddleOfTheLens) {
  for (const bool perspective : {true, false}) {
    Scene scene = scene_of(square(V3f(0, 0.7071f, 0.7071f)));
    scene.lights.clear();
    Camera camera = look_at(V3f(0, 3, perspective ? 0.05f : 0), V3f(0, 0, 0), V3f(0, 0, 1), 0.5f);
    if (!perspective) camera.kind = Camera::Kind::orthographic;
    camera.half_height = 1;
    camera.lens_radius = 0.8f;
    camera.focus_distance = 3;
    scene.cameras = {camera};
    RenderOptions options = options_of(Normals::shading);
    options.look = {};
    options.spp = 64;
    const Film film = render(scene, options).film;
    double towards = 0, seen = 0;
    for (std::size_t p = 0; p < film.find("A")->pixels.size(); ++p) {
      const double alpha = film.find("A")->pixels[p];
      if (alpha == 0) continue;
      towards += alpha * film.find("N.Y")->pixels[p];
      seen += alpha;
    }
    ASSERT_GT(seen, 10) << perspective;
    EXPECT_NEAR(towards / seen, 0.7071, 0.02) << perspective;
  }
}

// As exporters write them at folds: the sum of a triangle's normals is on its side, one is not.
TEST(ShadingNormal, ThoseBehindTheirTriangleAreMirroredToItsFront) {
  Mesh mesh = square({0, 0, 1});
  mesh.normals[1] = V3f(0.8f, 0, -0.6f);
  const Scene scene = scene_of(mesh);
  RenderOptions options = options_of(Normals::shading);
  options.look = LookAt{V3f(0, 0, 300), V3f(0, 0, 0), V3f(0, 1, 0)};
  options.fov_degrees = 0.36f;
  const Film film = render(scene, options).film;
  const auto &x = film.find("N.X")->pixels, &z = film.find("N.Z")->pixels;
  for (std::size_t p = 0; p < x.size(); ++p) {
    if (film.find("A")->pixels[p] < 1) continue;
    EXPECT_GE(x[p], -0.01f) << "all lean to +X";
    EXPECT_GE(z[p], -0.01f);
    EXPECT_GE(std::hypot(x[p], z[p]), 0.7) << "those at the crease may turn to the viewer";
  }
}

/// Layers that both films have, at pixels where `counts` is true, are the same bits.
template <class Counts>
void expect_same_bits(const Film& a, const Film& b, const Counts& counts) {
  for (const char* channel :
       {"R", "A", "ao.R", "bent.X", "bent.Y", "light.sun.R", "N.X", "N.Y", "N.Z", "P.X", "Z"}) {
    const auto &of_a = a.find(channel)->pixels, &of_b = b.find(channel)->pixels;
    std::size_t different = 0;
    for (std::size_t p = 0; p < of_a.size(); ++p) different += counts(p) && of_a[p] != of_b[p];
    EXPECT_EQ(different, 0u) << channel;
  }
}

/// Every triangle of the mesh with corners of its own, whose normals are the face's.
Mesh faceted(const Mesh& mesh) {
  Mesh flat;
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const std::uint32_t* corner = &mesh.indices[3 * t];
    const V3f a = mesh.positions[corner[0]], b = mesh.positions[corner[1]],
              c = mesh.positions[corner[2]];
    for (const V3f& p : {a, b, c}) {
      flat.indices.push_back(static_cast<std::uint32_t>(flat.positions.size()));
      flat.positions.push_back(p);
      flat.normals.push_back((b - a).cross(c - a).normalized());
    }
  }
  return flat;
}

TEST(ShadingNormal, FlatScenesAreTheSameBitForBit) {
  Scene scene = scene_of(faceted(smooth_sphere()));
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const Film shading = render(scene, options_of(Normals::shading, estimator)).film;
    const Film geometric = render(scene, options_of(Normals::geometric, estimator)).film;
    expect_same_bits(shading, geometric, [](std::size_t) { return true; });
    EXPECT_EQ(shading.find("Ng.X"), nullptr);
  }
}

// Beside a smooth mesh the shading pass runs, and leaves the flat one as it is.
TEST(ShadingNormal, AFlatMeshBesideASmoothOneIsTheSameBitForBit) {
  Scene scene = scene_of(faceted(smooth_sphere()));
  Mesh smooth = smooth_sphere();
  for (V3f& p : smooth.positions) p += V3f(2.2f, 0, 0);
  smooth.materials.assign(504, 0);
  scene.meshes.push_back(smooth);
  scene.instances.resize(2);
  scene.instances[1].mesh = 1;
  const Film shading = render(scene, options_of(Normals::shading)).film;
  const Film geometric = render(scene, options_of(Normals::geometric)).film;
  ASSERT_NE(shading.find("Ng.X"), nullptr);
  const auto& x = shading.find("P.X")->pixels;
  expect_same_bits(shading, geometric, [&](std::size_t p) { return x[p] < 0.5f; });
}

/// The largest difference of two pictures' shading normals, at pixels that are full in both.
double worst_normal(const Film& a, const Film& b) {
  double worst = 0;
  const auto &full = a.find("A")->pixels, &also = b.find("A")->pixels;
  int counted = 0;
  for (std::size_t p = 0; p < full.size(); ++p) {
    if (full[p] < 1 || also[p] < 1) continue;
    ++counted;
    worst = std::max<double>(worst, (three(a, "N", p) - three(b, "N", p)).length());
  }
  EXPECT_GT(counted, 200);
  return worst;
}

/// A mirrored, stretched and turned sphere. Its second placement keeps the mesh an instance; more
/// than 256 triangles, so that instances stay.
Scene placed_sphere() {
  Scene placed = scene_of(smooth_sphere());
  M44f matrix;
  matrix.rotate(V3f(0.3f, 0.9f, 0));
  matrix.scale(V3f(-0.9f, 0.5f, 0.9f));
  placed.instances.resize(2);
  placed.instances[0].to_world = matrix;
  placed.instances[1].to_world.setTranslation(V3f(50, 0, 0));
  return placed;
}

// Two meshes of one placement each are merged.
TEST(ShadingNormal, InstancesHaveTheNormalsOfTheSameMeshInWorldSpace) {
  Scene placed = placed_sphere();
  Scene merged = placed;
  merged.meshes.push_back(merged.meshes[0]);
  merged.instances[1].mesh = 1;
  placed.lights = merged.lights = {small_sun({1, 1, 1})};
  const RenderOptions options = options_of(Normals::shading);
  const Film a = render(placed, options).film, b = render(merged, options).film;
  // Stretching and interpolating do not commute, but nearly do over a small triangle.
  EXPECT_LE(worst_normal(a, b), 0.02);
  EXPECT_NEAR(mean_of(a, "ao.R"), mean_of(b, "ao.R"), 5e-4);
  EXPECT_NEAR(mean_of(a, "light.sun.R"), mean_of(b, "light.sun.R"), 5e-4);
}

// In nanometres, as some programs of plant models count.
TEST(ShadingNormal, InstancesOfTinyScalesKeepTheirNormals) {
  Mesh grid = test::smooth_sphere();
  for (V3f& position : grid.positions) position *= 1e9f;
  Scene scene = scene_of(grid);
  scene.instances = {{0, M44f().setScale(1e-9f)},
                     {0, M44f().setScale(1e-9f) * M44f().setTranslation(V3f(3, 0, 0))}};
  Scene in_metres = scene_of(test::smooth_sphere());
  in_metres.instances = {{0, M44f()}, {0, M44f().setTranslation(V3f(3, 0, 0))}};
  const RenderOptions options = options_of(Normals::shading);
  const Film a = render(scene, options).film, b = render(in_metres, options).film;
  EXPECT_LE(worst_normal(a, b), 0.02);
  EXPECT_NEAR(mean_of(a, "ao.R"), mean_of(b, "ao.R"), 5e-4);
}

// Camera rays do not depend on the normals, so that both pictures sum the same normals.
TEST(ShadingNormal, TheLayerNgHasTheGeometricNormalsBitForBit) {
  Renderer renderer;
  for (const Scene& scene : {scene_of(smooth_sphere()), placed_sphere()}) {
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      RenderOptions options = options_of(Normals::shading, estimator);
      options.light = false;
      const Film smooth = renderer.render(scene, options).film;
      options.normals = Normals::geometric;
      const Film faceted = renderer.render(scene, options).film;
      ASSERT_NE(smooth.find("Ng.X"), nullptr);
      int full = 0;
      float farthest = 0;
      for (std::size_t p = 0; p < smooth.find("A")->pixels.size(); ++p) {
        if (smooth.find("A")->pixels[p] < 1) continue;
        ++full;
        const V3f geometric = three(smooth, "Ng", p);
        EXPECT_EQ(geometric, three(faceted, "N", p)) << "pixel " << p;
        farthest = std::max(farthest, (geometric - three(smooth, "N", p)).length());
      }
      EXPECT_GT(full, 400);
      EXPECT_GT(farthest, 0.1f) << "N has those of the round sphere";
    }
  }
}

TEST(ShadingNormal, RefittedMeshesHaveTheNormalsOfTheirNewForm) {
  Scene scene = scene_of(smooth_sphere());
  scene.lights = {small_sun({1, 1, 1})};
  const auto bent = [&](float amount) {
    Scene moved = scene;
    for (std::size_t v = 0; v < moved.meshes[0].positions.size(); ++v) {
      const float angle = amount * moved.meshes[0].positions[v].y;
      M44f turn;
      turn.rotate(V3f(0, angle, angle));
      turn.multVecMatrix(scene.meshes[0].positions[v], moved.meshes[0].positions[v]);
      turn.multDirMatrix(scene.meshes[0].normals[v], moved.meshes[0].normals[v]);
    }
    return moved;
  };
  const RenderOptions options = options_of(Normals::shading);
  Renderer renderer;
  renderer.render(scene, options);
  renderer.render(bent(0.1f), options);
  const RenderResult refitted = renderer.render(bent(0.4f), options);
  EXPECT_EQ(refitted.statistics.refit.objects_refitted, 1u);
  const Film fresh = render(bent(0.4f), options).film;
  EXPECT_LE(worst_normal(refitted.film, fresh), 1e-5);
  EXPECT_NEAR(mean_of(refitted.film, "light.sun.R"), mean_of(fresh, "light.sun.R"), 1e-5);
  // Another choice of normals uploads the scene anew.
  EXPECT_EQ(renderer.render(bent(0.4f), options_of(Normals::geometric)).film.find("Ng.X"), nullptr);
  EXPECT_NE(renderer.render(bent(0.4f), options).film.find("Ng.X"), nullptr);
}

}  // namespace
}  // namespace dapple
