// Bakes of meshes with normals: closed forms of a smooth sphere and of tilted cards, the same
// values as in a picture, and flat meshes bit for bit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>

#include "bake/occluder_scene.hpp"
#include "bake/samples/light_tracer.hpp"
#include "bake/samples/sample_tracer.hpp"
#include "dapple/bake.hpp"
#include "support/not_empty.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

using namespace scene_test;
using test::scene_of;

Light small_sun(const V3f& towards) {
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = -towards.normalized();
  sun.angular_radius = 0.02f;
  sun.radiance = V3f(1 / (std::numbers::pi_v<float> * 4e-4f));  // irradiance 1 across it
  return sun;
}

/// Exact rays, of equal number everywhere.
BakeOptions exactly(int rays) {
  BakeOptions options;
  options.target_error = 0;
  options.rays = rays;
  options.estimator = Estimator::exact;
  return options;
}

/// A part of the unit sphere, 120 degrees wide and high, of 8 by 8 quads.
constexpr int kQuads = 8;

V3f on_sphere(float u, float v) {
  const float around = (u - 0.5f) * 2.0944f, up = (0.5f - v) * 2.0944f;
  return {std::cos(up) * std::sin(around), std::sin(up), std::cos(up) * std::cos(around)};
}

Scene sphere_part(std::vector<V2f>& uvs) {
  Mesh mesh;
  for (int row = 0; row <= kQuads; ++row) {
    for (int column = 0; column <= kQuads; ++column) {
      uvs.emplace_back(static_cast<float>(column) / kQuads, static_cast<float>(row) / kQuads);
      mesh.positions.push_back(on_sphere(uvs.back().x, uvs.back().y));
    }
  }
  mesh.normals = mesh.positions;
  for (std::uint32_t row = 0; row < kQuads; ++row) {
    for (std::uint32_t column = 0; column < kQuads; ++column) {
      const std::uint32_t a = row * (kQuads + 1) + column, c = a + kQuads + 1;
      mesh.indices.insert(mesh.indices.end(), {a, c, a + 1, a + 1, c, c + 1});
    }
  }
  return scene_of(std::move(mesh));
}

// The light of a distant sun on a smooth sphere is the cosine, and nothing of it is occluded.
TEST(SmoothBake, TexelsOfASphereShowNoFacets) {
  BakeOptions options = exactly(64);
  const Scene scene = sphere_part(options.texture_uvs.emplace_back());
  const V3f towards = V3f(1, 0.9f, 0.15f).normalized();
  options.vertices = false;
  options.texture = options.light = true;
  options.lights = {small_sun(towards)};
  options.texture_size = 96;
  for (const Normals normals : {Normals::shading, Normals::geometric}) {
    options.normals = normals;
    const BakedTexture texture = bake(scene, options).texture;
    float worst = 0, darkest = 1;
    for (std::uint32_t i = 0; i < texture.ao.size(); ++i) {
      const auto x = static_cast<float>(i % 96), y = static_cast<float>(i / 96);
      const float cosine = on_sphere((x + 0.5f) / 96, (y + 0.5f) / 96).dot(towards);
      worst = std::max(worst, std::fabs(texture.light.at(0)[i].x - std::max(0.0f, cosine)));
      darkest = std::min(darkest, texture.ao[i]);
    }
    if (normals == Normals::shading) {
      EXPECT_LE(worst, 0.02f);
    } else {
      EXPECT_GE(worst, 0.1f) << "facets";
    }
    EXPECT_GE(darkest, 0.999f);
  }
}

TEST(SmoothBake, VerticesOfASphereOf504TrianglesAreUnoccludedAndAsBrightAsTheirCosine) {
  const Scene scene = scene_of(test::smooth_sphere());
  const V3f towards = V3f(1, 0.3f, 0.4f).normalized();
  for (const bool at_vertices : {false, true}) {
    BakeOptions options = exactly(512);
    options.light = true;
    options.lights = {small_sun(towards)};
    options.at_vertices = at_vertices;
    const BakedMesh baked = bake(scene, options).meshes.at(0);
    // Without the poles, where vertices of single triangles lie at one place.
    for (std::size_t v = 21; v < baked.ao.size() - 21; ++v) {
      // Single vertices stand on means of triangles by area, too, 5 degrees off at the poles.
      EXPECT_GE(baked.ao[v], at_vertices ? 0.99f : 0.999f);
      // The mean of triangles around a vertex of the terminator, a quarter of which are lit.
      EXPECT_NEAR(baked.light.at(0)[v].x, std::max(0.0f, scene.meshes[0].normals[v].dot(towards)),
                  at_vertices ? 0.025f : 0.06f);
    }
  }
}

// Rays start on the smooth sphere, 3 mm above its facets: not where a sheet lies between.
TEST(SmoothBake, ASphereThatTouchesASheetIsDarkWhereItDoes) {
  Scene scene = scene_of(test::smooth_sphere());
  Mesh sheet;
  append_grid(sheet, {-20, -1, -20}, {0, 0, 40}, {40, 0, 0}, 1, 0);
  scene.meshes.push_back(sheet);
  scene.instances.resize(2);
  scene.instances[1].mesh = 1;
  BakeOptions options = exactly(512);
  options.light = true;
  options.lights = {small_sun({0, -1, 0})};  // from below the sheet
  const BakedMesh baked = bake(scene, options).meshes.at(0);
  const std::vector<V3f>& positions = scene.meshes[0].positions;
  int below = 0;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (positions[v].y > -0.95f) continue;
    ++below;
    EXPECT_LE(baked.ao[v], 0.06f) << positions[v];
    EXPECT_LE(baked.light.at(0)[v].x, 0.01f) << positions[v];
  }
  EXPECT_GE(below, 20);
}

// The sides of a steep pyramid face away from each other: their normals at the apex are up.
TEST(SmoothBake, TheApexOfASteepPyramidSeesAllAboveIt) {
  Mesh mesh;
  mesh.positions = {{1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {-1, 0, 1}, {0, 5, 0}};
  for (const V3f& corner : mesh.positions) mesh.normals.push_back(corner.normalized());
  for (std::uint32_t side = 0; side < 4; ++side) {
    mesh.indices.insert(mesh.indices.end(), {side, (side + 1) % 4, 4});
    mesh.materials.push_back(0);
  }
  for (const bool has_normals : {true, false}) {
    if (!has_normals) mesh.normals.clear();
    BakeOptions options = exactly(1024);
    options.at_vertices = options.bent = true;
    const BakedMesh baked = bake(scene_of(mesh), options).meshes.at(0);
    EXPECT_GT(baked.bent.at(4).y, 0.95f) << has_normals;
    EXPECT_GT(baked.ao.at(4), 0.95f) << has_normals;
  }
}

// As in ShadingNormal.ATiltedHemisphereIsHiddenBelowThePlane, on both sides.
TEST(SmoothBake, ATiltedCardIsHiddenBelowItsPlane) {
  Mesh mesh;
  append_grid(mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 0);
  const auto theta = static_cast<float>(kPi / 3);
  mesh.normals.assign(mesh.positions.size(), V3f(0, std::sin(theta), std::cos(theta)));
  Scene scene = scene_of(std::move(mesh));
  scene.materials[0].double_sided = true;
  for (const BakeSides sides : {BakeSides::front, BakeSides::max, BakeSides::mean}) {
    for (const bool at_vertices : {false, true}) {
      for (const bool bent : {false, true}) {  // other kernels
        BakeOptions options = exactly(at_vertices ? 4096 : 1024);
        options.sides = sides;
        options.at_vertices = at_vertices;
        options.bent = bent;
        for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
          options.estimator = estimator;
          const BakeResult result = bake(scene, options);
          for (const float ao : not_empty(result.meshes.at(0).ao))
            EXPECT_NEAR(ao, (1 + std::cos(theta)) / 2, 0.02)
                << int(sides) << at_vertices << bent << int(estimator);
        }
      }
    }
  }
  BakeOptions options = exactly(1024);
  options.light = true;
  options.lights = {small_sun({0, 1, -0.05f}), small_sun({0, 0, 1})};
  options.sides = BakeSides::front;
  const BakedMesh lit = bake(scene, options).meshes.at(0);
  for (std::size_t v = 0; v < lit.ao.size(); ++v) {
    EXPECT_EQ(lit.light.at(0)[v].x, 0) << "below the surface, above the hemisphere's horizon";
    EXPECT_NEAR(lit.light.at(1)[v].x, std::cos(theta), 0.005);
  }
}

/// What a picture of one pixel shows of the sample's side.
std::pair<double, double> seen_by_camera(const Scene& scene, const V3f& position, const V3f& side) {
  RenderOptions options;
  options.width = options.height = 1;
  options.spp = 64;
  options.ao_rays = options.light_rays = 64;
  options.estimator = Estimator::exact;
  options.fov_degrees = 1;
  options.albedo = false;
  const V3f up = std::fabs(side.y) < 0.9f ? V3f(0, 1, 0) : V3f(1, 0, 0);
  options.look = LookAt{position + side * 1e-2f, position, up};
  Scene copy = scene;
  const Film film = render(copy, options).film;
  EXPECT_EQ(film.find("A")->pixels[0], 1);
  return {double{film.find("ao.R")->pixels[0]}, double{film.find("light.sun.R")->pixels[0]}};
}

// A torus that is mirrored, stretched and turned: convex and concave, with its own shadow on it.
// Its triangles face inwards, so that the back is what one sees of it.
TEST(SmoothBake, SamplesAreAsBrightAsAPictureOfThem) {
  Scene scene = test::smooth_torus(24, 12);
  scene.materials[0].double_sided = true;
  M44f& matrix = scene.instances[0].to_world;
  matrix.rotate(V3f(0.3f, 0.9f, 0));
  matrix.scale(V3f(-0.9f, 0.6f, 0.8f));
  scene.lights = {small_sun({1, 1, 1})};
  BakeOptions options = exactly(4096);
  options.light = true;
  const OccluderScene occluders(Device(), scene, options, {});
  const Mesh& mesh = scene.meshes[0];
  const std::vector<bool> two_sided(mesh.primitive_count(), true);
  const VertexGroups groups = group_vertices(mesh, two_sided);
  std::vector<SurfaceSample> samples;
  for (std::uint32_t t = 5; t < mesh.primitive_count(); t += 47)
    samples.push_back(sample_triangle({mesh, groups, two_sided}, t, t));
  const std::vector<std::uint32_t> placement(samples.size(), 0);
  Placements placements;
  placements.add(matrix);
  const auto trace = [&](const QueryPoints& points, const OcclusionOptions& how, bool bent) {
    return point_occlusion(occluders.device, occluders.uploaded, points, how, bent);
  };
  const TracedSamples ao = ao_tracer(trace, options)(samples, placement, placements, 4096, 1);
  const TracedSamples light =
      light_tracer(options, occluders)(samples, placement, placements, 4096, 1);
  int occluded = 0, hidden = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    V3f geometric;
    placements.to_object[0].transposed().multDirMatrix(samples[i].geometric, geometric);
    geometric.normalize();
    const V3f position = samples[i].position * matrix;
    const auto front = seen_by_camera(scene, position, geometric);
    const auto back = seen_by_camera(scene, position, -geometric);
    // 4,096 rays each: half a percent. The rest is the penumbra, and normals in 21 bits.
    EXPECT_NEAR(ao.front[i].scalar, front.first, 0.015) << i;
    EXPECT_NEAR(ao.back[i].scalar, back.first, 0.015) << i;
    EXPECT_NEAR(light.front_light[i].x, front.second, 0.025) << i;
    EXPECT_NEAR(light.back_light[i].x, back.second, 0.025) << i;
    occluded += back.first < 0.8;
    hidden += back.second < 0.01;
  }
  EXPECT_GT(occluded, 1);
  EXPECT_GT(hidden, 1);
  EXPECT_LT(hidden, static_cast<int>(samples.size()) - 1);
}

/// Every triangle with corners of its own, whose normals are the face's.
Scene faceted_sphere() {
  const Mesh smooth = test::smooth_sphere();
  Mesh flat;
  for (std::size_t t = 0; t < smooth.indices.size() / 3; ++t) {
    for (std::size_t k = 3 * t; k < 3 * t + 3; ++k) {
      flat.indices.push_back(static_cast<std::uint32_t>(flat.positions.size()));
      flat.positions.push_back(smooth.positions[smooth.indices[k]]);
      flat.normals.push_back(area_vector(smooth, t).normalized());
    }
  }
  Scene scene = scene_of(std::move(flat));
  scene.materials[0].double_sided = true;
  return scene;
}

TEST(SmoothBake, FlatMeshesAreTheSameBitForBit) {
  const Scene with_normals = faceted_sphere();
  Scene without = with_normals;
  without.meshes[0].normals.clear();
  BakeOptions options;
  options.light = options.bent = options.ground = true;
  options.lights = {small_sun({1, 1, 1})};
  for (const bool at_vertices : {false, true}) {
    options.at_vertices = at_vertices;
    options.texture = !at_vertices;
    options.texture_size = 256;
    const BakeResult a = bake(with_normals, options), b = bake(without, options);
    const auto same = [](const auto& x, const auto& y) {
      return x.size() == y.size() &&
             (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0);
    };
    EXPECT_TRUE(same(a.meshes.at(0).ao, b.meshes.at(0).ao));
    EXPECT_TRUE(same(a.meshes[0].bent, b.meshes[0].bent));
    EXPECT_TRUE(same(a.meshes[0].light.at(0), b.meshes[0].light.at(0)));
    EXPECT_TRUE(same(a.texture.ao, b.texture.ao));
  }
}

// Cards of grass often have the normals of the ground. They stand on y = 0, where the coordinates
// along these normals are small and those along their own are not.
TEST(SmoothBake, LeaningCardsWithNormalsUpAreNotHiddenByThemselvesAnywhere) {
  double at_origin = 0;
  for (const float offset : {0.0f, 30.0f, 3000.0f}) {
    Mesh card;
    constexpr int kParts = 6;
    for (int row = 0; row <= kParts; ++row)
      for (int column = 0; column <= kParts; ++column) {
        const float a = static_cast<float>(column) / kParts - 0.5f;
        const float b = 0.5f * static_cast<float>(row) / kParts;
        card.positions.emplace_back(0.765f * a - 0.19f * b + offset, 0.955f * b,
                                    0.644f * a + 0.226f * b + 0.7f * offset);
      }
    card.normals.assign(card.positions.size(), V3f(0, 1, 0));
    for (std::uint32_t row = 0; row < kParts; ++row)
      for (std::uint32_t column = 0; column < kParts; ++column) {
        const std::uint32_t a = row * (kParts + 1) + column, c = a + kParts + 1;
        card.indices.insert(card.indices.end(), {a, a + 1, c, a + 1, c + 1, c});
      }
    BakeOptions options = exactly(1024);
    options.sides = BakeSides::max;
    const std::vector<float> ao = bake(scene_of(std::move(card)), options).meshes.at(0).ao;
    const double mean = std::accumulate(ao.begin(), ao.end(), 0.0) / static_cast<double>(ao.size());
    if (offset == 0) at_origin = mean;
    EXPECT_NEAR(mean, at_origin, 0.01) << offset;
    EXPECT_GT(mean, 0.5) << offset;
  }
}

}  // namespace
}  // namespace dapple
