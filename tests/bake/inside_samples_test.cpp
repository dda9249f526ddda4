// Samples inside closed geometry: which parts of a mesh are closed, which points they surround, and
// that baked values do not count such samples, where surfaces pass through boxes or stand below
// them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bake/inside/closed_geometry.hpp"
#include "bake/inside/closed_parts.hpp"
#include "dapple/bake.hpp"
#include "support/not_empty.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// Appends a box whose sides have vertices of their own, facing outwards.
void append_box(Mesh& mesh, const V3f& low, const V3f& high) {
  const V3f x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  append_grid(mesh, low, z, y, 1, 0);
  append_grid(mesh, low + x, y, z, 1, 0);
  append_grid(mesh, low, x, z, 1, 0);
  append_grid(mesh, low + y, z, x, 1, 0);
  append_grid(mesh, low, y, x, 1, 0);
  append_grid(mesh, low + z, x, y, 1, 0);
}

Mesh box_mesh(const V3f& low, const V3f& high) {
  Mesh mesh;
  append_box(mesh, low, high);
  return mesh;
}

void turn(Mesh& mesh) {
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t)
    std::swap(mesh.indices[3 * t], mesh.indices[3 * t + 1]);
}

/// A tube about the Y axis from y = 0 to 8, of radius 1 and so many sides, without ends.
Mesh tube_mesh(std::uint32_t sides) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * kPi * i / sides;
    const V3f at(static_cast<float>(std::cos(angle)), 0, static_cast<float>(-std::sin(angle)));
    mesh.positions.insert(mesh.positions.end(), {at, at + V3f(0, 8, 0)});
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % sides);
    mesh.indices.insert(mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
    mesh.materials.insert(mesh.materials.end(), {0, 0});
  }
  return mesh;
}

Scene scene_of(Mesh mesh, bool double_sided = false) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].double_sided = double_sided;
  place(scene, std::move(mesh));
  return scene;
}

std::size_t closed_count(const Mesh& mesh) {
  return closed_parts(mesh, std::vector<bool>(mesh.primitive_count(), true)).count;
}

TEST(ClosedParts, AreBoxesAndTubesAndNotSheets) {
  Mesh boxes = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(closed_count(boxes), 1u) << "its sides share no vertices";
  append_box(boxes, {2, 0, 0}, {3, 1, 1});
  EXPECT_EQ(closed_count(boxes), 2u);
  turn(boxes);
  EXPECT_EQ(closed_count(boxes), 2u);
  for (const std::uint32_t sides : {3u, 8u}) EXPECT_EQ(closed_count(tube_mesh(sides)), 1u) << sides;
  EXPECT_EQ(closed_count(square_mesh(1, 0, 8, 0)), 0u);
  Mesh open = box_mesh({0, 0, 0}, {1, 1, 1});
  open.indices.resize(open.indices.size() - 6);
  open.materials.resize(open.materials.size() - 2);
  EXPECT_EQ(closed_count(open), 0u) << "a sixth is open";
}

TEST(ClosedParts, AreOpaque) {
  Mesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  Scene scene = scene_of(box);
  const auto count = [&] {
    return closed_parts(box, opaque_triangles(scene, OpaqueTexels(scene), box)).count;
  };
  EXPECT_EQ(count(), 1u);
  scene.materials[0].alpha_mode = AlphaMode::blend;
  EXPECT_EQ(count(), 1u) << "its alpha is 1";
  scene.materials[0].alpha = 0.9f;
  EXPECT_EQ(count(), 0u);
  scene.materials[0].alpha_mode = AlphaMode::mask;
  EXPECT_EQ(count(), 1u);
  scene.materials[0].alpha_texture = 0;
  scene.textures.resize(1);
  scene.textures[0].width = scene.textures[0].height = 1;
  scene.textures[0].alpha = {0};
  EXPECT_EQ(count(), 1u) << "without texture coordinates";
  box.uvs.assign(box.positions.size(), V2f(0, 0));
  EXPECT_EQ(count(), 0u);
  scene.textures[0].alpha = {255};
  EXPECT_EQ(count(), 1u);
  scene.materials[0].alpha_texture = -1;
  box.vertex_alpha.assign(box.positions.size(), 1);
  EXPECT_EQ(count(), 1u) << "COLOR_0 is opaque";
  box.vertex_alpha[0] = 0;
  EXPECT_EQ(count(), 0u);
}

/// On how many of 100 sides `scene` surrounds the point.
int surrounding_directions(const Scene& scene, const V3f& point) {
  ClosedGeometry closed(scene);
  closed.prepare();
  Points random(7);
  int found = 0;
  for (int i = 0; i < 100; ++i) found += closed.surrounds(point, random.on_sphere()) ? 1 : 0;
  return found;
}

TEST(ClosedGeometry, SurroundsWhatIsInABoxWhateverElseIsThere) {
  Scene scene = scene_of(box_mesh({-1, -1, -1}, {1, 1, 1}));
  for (const V3f& in : {V3f(0, 0, 0), V3f(0.99f, 0, 0), V3f(-0.9f, 0.9f, 0.9f)})
    EXPECT_EQ(surrounding_directions(scene, in), 100) << in;
  for (const V3f& out : {V3f(1.01f, 0, 0), V3f(0, 3, 0), V3f(-1.1f, 0.9f, 0.9f)})
    EXPECT_EQ(surrounding_directions(scene, out), 0) << out;
  Mesh room = box_mesh({-5, -5, -5}, {5, 5, 5});
  turn(room);
  place(scene, room);
  place(scene, square_mesh(1.9f, 0.5f, 2, 0));
  merge_single_instances(scene);
  EXPECT_EQ(surrounding_directions(scene, {0, 0, 0}), 100);
  EXPECT_EQ(surrounding_directions(scene, {3, 0, 0}), 0) << "in the room";
}

// Most rays from a point near the mouth of a tube meet its side, and one that is open is decisive.
TEST(ClosedGeometry, TubesDoNotSurroundTheirMouths) {
  const Scene scene = scene_of(tube_mesh(24));
  EXPECT_GT(surrounding_directions(scene, {0, 4, 0}), 90);
  EXPECT_LT(surrounding_directions(scene, {0, 1.1f, 0}), 50);
}

TEST(ClosedGeometry, SurroundsWhatIsInAnInstanceMirroredOrNot) {
  Scene scene = scene_of(box_mesh({-1, -1, -1}, {1, 1, 1}));
  M44f mirrored;
  mirrored.setScale(V3f(-2, 1, 0.5f));
  mirrored[3][0] = 10;
  scene.instances.push_back({0, mirrored});
  EXPECT_EQ(surrounding_directions(scene, {0, 0, 0.9f}), 100);
  EXPECT_EQ(surrounding_directions(scene, {11.9f, 0, 0.4f}), 100);
  EXPECT_EQ(surrounding_directions(scene, {10, 0, 0.6f}), 0);
}

TEST(ClosedGeometry, NoSheetsSurroundAPoint) {
  // A canopy of large leaves above, all of whose backs are seen, and a tent.
  Mesh canopy;
  for (const float y : {1.0f, 1.5f, 2.0f})
    append_grid(canopy, {-50, y, 50}, {100, 0, 0}, {0, 0, -100}, 4, 0);
  append_grid(canopy, {-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, 1, 0);
  EXPECT_EQ(surrounding_directions(scene_of(canopy), {0, 0.5f, 0}), 0);
  Mesh tent;
  append_grid(tent, {0, 1, 1}, {-1, -1, 0}, {0, 0, -2}, 1, 0);
  append_grid(tent, {0, 1, -1}, {1, -1, 0}, {0, 0, 2}, 1, 0);
  EXPECT_EQ(surrounding_directions(scene_of(tent), {0, 0.5f, 0}), 0);
}

/// A floor of two triangles, 4 x 4 metres, at y = 0. Its samples below the box are as dark as the
/// box is wide, 3 x 3 metres; from others it is hardly seen, being flat.
Scene floor_scene() { return scene_of(square_mesh(4, 0, 1, 0)); }

Scene flat_box(float bottom) {
  return scene_of(box_mesh({-1.5f, bottom, -1.5f}, {1.5f, 0.01f, 1.5f}));
}

BakeOptions few_rays() {
  BakeOptions options;
  options.target_error = 0;
  options.rays = 512;
  return options;
}

TEST(InsideSamples, AFloorIsNotDarkerAtItsVerticesBelowABox) {
  for (const float bottom : {-1.0f, 0.0f}) {  // through the floor, and standing on it
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      BakeOptions options = few_rays();
      options.estimator = estimator;
      const BakeResult result = bake(floor_scene(), options, {}, {flat_box(bottom)});
      for (const float ao : not_empty(result.meshes.at(0).ao)) EXPECT_GT(ao, 0.96f) << bottom;
      // 9/16 of the floor; 128 samples.
      EXPECT_NEAR(static_cast<double>(result.statistics.inside_samples), 72, 8) << bottom;
      EXPECT_EQ(result.statistics.enclosed_vertices + result.statistics.dark_vertices, 0u);
    }
  }
}

TEST(ClosedGeometry, AMirroredMeshThatIsMergedAloneSurrounds) {
  Scene scene = scene_of(box_mesh({-1, -1, -1}, {1, 1, 1}));
  scene.instances.at(0).to_world.setScale(V3f(-1, 1, 1));
  merge_single_instances(scene);
  EXPECT_EQ(scene.instances.at(0).to_world, M44f());
  EXPECT_EQ(surrounding_directions(scene, {0, 0, 0}), 100);
}

// A box that is placed once is merged with the floor.
TEST(InsideSamples, AMirroredBoxHidesAsABoxDoes) {
  Scene box = flat_box(-1);
  box.instances.at(0).to_world.setScale(V3f(-1, 1, 1));
  const BakeResult result = bake(floor_scene(), few_rays(), {}, {box});
  for (const float ao : not_empty(result.meshes.at(0).ao)) EXPECT_GT(ao, 0.96f);
  EXPECT_NEAR(static_cast<double>(result.statistics.inside_samples), 72, 8);
}

TEST(InsideSamples, WithATargetTooAndOnBothSides) {
  Scene floor = floor_scene();
  floor.materials[0].double_sided = true;
  BakeOptions options;
  options.sides = BakeSides::mean;
  const BakeResult through = bake(floor, options, {}, {flat_box(-0.01f)});
  for (const float ao : not_empty(through.meshes.at(0).ao)) EXPECT_GT(ao, 0.94f);
  EXPECT_GT(through.statistics.inside_samples, 0u);
  // The lower side of the floor below a box that stands on it is open.
  const BakeResult on = bake(floor, options, {}, {flat_box(0)});
  EXPECT_EQ(on.statistics.inside_samples, 0u);
  for (const float ao : not_empty(on.meshes.at(0).ao)) EXPECT_LT(ao, 0.85f);
}

// Half of the samples are on a grid of 3,200 triangles inside of a box, where nothing has a bias.
// All are in one mesh, so that they are traced, and compared, at once.
TEST(InsideSamples, TheReportedBiasDoesNotCountThem) {
  BakeOptions options = few_rays();
  options.rays = 64;
  options.footprint = 64;
  options.report_bias = 1;
  Scene scene = make_procedural("scene:palm?leaves=10");
  Mesh& mesh = scene.meshes.at(0);
  mesh.normals.clear();
  const Bias alone = bake(scene, options).statistics.bias.at("ao");
  const auto opaque = static_cast<std::uint32_t>(scene.materials.size());
  scene.materials.emplace_back();
  const std::size_t palm = mesh.primitive_count();
  const V3f away(100, 0, 0);
  append_box(mesh, away - V3f(1, 1, 1), away + V3f(1, 1, 1));
  append_grid(mesh, away - V3f(0.5f, 0, 0.5f), V3f(0, 0, 1), V3f(1, 0, 0), 40, 0);
  std::fill(mesh.materials.begin() + palm, mesh.materials.end(), opaque);
  const BakeResult result = bake(scene, options);
  ASSERT_GT(result.statistics.inside_samples, 3200u);
  const Bias beside = result.statistics.bias.at("ao");
  EXPECT_LT(alone.mean, -10 * alone.error);
  EXPECT_NEAR(beside.mean / alone.mean, 1, 0.15) << "0.5 with those inside";
}

TEST(InsideSamples, AnOpenSheetStillDarkensWhatLiesBelow) {
  const Scene sheet = scene_of(square_mesh(3, 0.001f, 1, 0));
  const BakeResult result = bake(floor_scene(), few_rays(), {}, {sheet});
  EXPECT_EQ(result.statistics.inside_samples, 0u);
  double sum = 0;
  for (const float ao : not_empty(result.meshes.at(0).ao)) sum += double{ao} / 4;
  EXPECT_LT(sum, 0.6) << "9/16 of the floor see nothing";
}

// Nothing is closed here, so that no value may come from the floor's border.
TEST(InsideSamples, UnderAPlateWhatSeesNextToNothingStaysDark) {
  Scene floor = scene_of(square_mesh(1, 0, 4, 0)), plate = scene_of(square_mesh(1, 0.01f, 1, 0));
  const Mesh& mesh = floor.meshes[0];
  BakeOptions options = few_rays();
  options.sides = BakeSides::front;
  options.at_vertices = options.texture = true;
  options.texture_size = 64;
  const BakeResult result = bake(floor, options, {}, {plate});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const V3f& at = mesh.positions[v];
    if (std::max(std::fabs(at.x), std::fabs(at.z)) > 0.4f) continue;  // at the border
    EXPECT_LT(result.meshes.at(0).ao[v], 0.01f) << at;
  }
  EXPECT_EQ(result.statistics.enclosed_vertices + result.statistics.enclosed_texels, 0u);
  EXPECT_GT(result.statistics.dark_vertices, 0u);
}

TEST(InsideSamples, TexelsOfAClosedRoomStayDarkBesideACourtyard) {
  Mesh room = box_mesh({-2, -2, -2}, {2, 2, 2});
  turn(room);
  Scene scene = scene_of(room);
  const Mesh courtyard = square_mesh(8, 5, 1, 0);
  scene.meshes.push_back(courtyard);
  scene.instances.push_back({1, M44f(), -1});
  BakeOptions options = few_rays();
  options.vertices = false;
  options.texture = true;
  options.texture_size = 128;
  options.sides = BakeSides::front;
  options.estimator = Estimator::exact;
  const BakeResult result = bake(scene, options);
  const std::vector<V2f>& corners = result.texture.layout.corners.at(0);
  for (std::size_t corner = 0; corner < corners.size(); corner += 3) {
    const V2f middle =
        (corners[corner] + corners[corner + 1] + corners[corner + 2]) / 3.0f * 128.0f;
    EXPECT_EQ(result.texture.ao.at(static_cast<std::size_t>(middle.y) * 128 +
                                   static_cast<std::size_t>(middle.x)),
              0.0f)
        << corner;
  }
}

TEST(InsideSamples, TexelsHaveTheValueOfTheirVisiblePart) {
  BakeOptions options = few_rays();
  options.vertices = false;
  options.texture = true;
  options.texture_size = 4;
  options.margin = 0;
  options.texture_uvs = {{V2f(0, 0), V2f(1, 0), V2f(0, 1), V2f(1, 1)}};
  // Its sides cross the outer texels in their middle.
  const BakeResult result = bake(floor_scene(), options, {}, {flat_box(-1)});
  ASSERT_EQ(result.texture.ao.size(), 16u);
  for (const float ao : not_empty(result.texture.ao)) EXPECT_GT(ao, 0.93f);
  EXPECT_EQ(result.statistics.enclosed_texels, 4u) << "the inner ones";
}

TEST(InsideSamples, LightIsThatOfTheVisiblePart) {
  Light sun;
  sun.kind = LightKind::sun;
  sun.direction = V3f(0, -1, 0);
  sun.angular_radius = 0.01f;
  sun.radiance = V3f(10000, 10000, 10000);
  BakeOptions options = few_rays();
  options.light = true;
  options.lights = std::vector{sun};
  const double open = 10000 * kPi * std::pow(std::sin(0.01), 2);
  const BakeResult result = bake(floor_scene(), options, {}, {flat_box(-1)});
  for (const V3f& light : result.meshes.at(0).light.at(0))
    EXPECT_NEAR(double{light.x}, open, 0.03 * open);
}

TEST(InsideSamples, AMeshThatIsInsideAsAWholeStaysDark) {
  const Scene small = scene_of(box_mesh({-0.1f, -0.5f, -0.1f}, {0.1f, -0.3f, 0.1f}));
  const BakeResult result = bake(small, few_rays(), {}, {flat_box(-1)});
  EXPECT_GT(result.statistics.inside_samples, 0u);
  EXPECT_EQ(result.statistics.dark_vertices, 0u);  // these are of rooms
  EXPECT_EQ(result.statistics.enclosed_vertices, 0u);
  for (const float ao : not_empty(result.meshes.at(0).ao)) EXPECT_EQ(ao, 0);
}

TEST(InsideSamples, ChartsThatAreInsideAsAWholeStayBlackBesideOthers) {
  Scene scene = scene_of(box_mesh({-0.1f, -0.5f, -0.1f}, {0.1f, -0.3f, 0.1f}));
  place(scene, square_mesh(0.2f, 5, 1, 0));
  BakeOptions options = few_rays();
  options.vertices = false;
  options.texture = true;
  options.texture_size = 64;
  options.margin = 64;
  const BakeResult result = bake(scene, options, {}, {flat_box(-1)});
  const std::vector<V2f>& corners = result.texture.layout.corners.at(0);
  for (std::size_t corner = 0; corner < corners.size(); corner += 3) {
    const V2f middle = (corners[corner] + corners[corner + 1] + corners[corner + 2]) * (64.0f / 3);
    EXPECT_EQ(result.texture.ao.at(static_cast<std::size_t>(middle.y) * 64 +
                                   static_cast<std::size_t>(middle.x)),
              0.0f)
        << corner;
  }
  EXPECT_EQ(result.statistics.enclosed_texels, 0u) << "none has another's value";
}

TEST(InsideSamples, InAClosedRoomAreNone) {
  Mesh room = box_mesh({-2, -2, -2}, {2, 2, 2});
  turn(room);
  BakeOptions options = few_rays();
  options.estimator = Estimator::exact;
  const BakeResult result = bake(scene_of(room), options);
  EXPECT_EQ(result.statistics.inside_samples, 0u);
  EXPECT_EQ(result.statistics.dark_vertices, room.positions.size());
}

}  // namespace
}  // namespace dapple
