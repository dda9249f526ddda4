// Makes procedural shapes whose occlusion is known in closed form: sheets, a disk, a solid cube.
// In: checked parameters; out: a scene.
#include <cmath>
#include <numbers>

#include "scene/procedural/mesh_shapes.hpp"
#include "scene/procedural/scenes.hpp"

namespace dapple {
namespace {

constexpr float kSheetSide = 2;
constexpr float kGroundSide = 20;

// Adds a material "ground" and a square with that material at y = 0.
void add_test_ground(Scene& scene) {
  const auto material = static_cast<std::uint32_t>(scene.materials.size());
  scene.materials.push_back(opaque_material("ground"));
  Mesh ground;
  ground.name = "ground";
  append_square(ground, kGroundSide, 0, material);
  place(scene, std::move(ground));
}

// Appends one face of the unit cube centred at the origin; `out` is the face's outward normal.
void append_cube_face(Mesh& mesh, V3f out, int divisions) {
  const V3f u = perpendicular(out);
  const V3f v = out.cross(u);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto coordinate = [&](int i) {
    return static_cast<float>(i) / static_cast<float>(divisions) - 0.5f;
  };
  for (int j = 0; j <= divisions; ++j) {
    for (int i = 0; i <= divisions; ++i) {
      mesh.positions.push_back(out * 0.5f + u * coordinate(i) + v * coordinate(j));
    }
  }
  const auto row = static_cast<std::uint32_t>(divisions + 1);
  for (std::uint32_t j = 0; j + 1 < row; ++j) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t a = first + j * row + i;
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + row + 1, a, a + row + 1, a + row});
      mesh.materials.insert(mesh.materials.end(), {0, 0});
    }
  }
}

}  // namespace

Scene make_stack_scene(const ProceduralParameters& parameters) {
  Scene scene;
  scene.materials.push_back(blend_material("sheet", parameters.real("opacity")));
  Mesh sheets;
  sheets.name = "stack";
  for (std::uint32_t layer = 1; layer <= parameters.whole("layers"); ++layer) {
    append_square(sheets, kSheetSide, parameters.real("gap") * static_cast<float>(layer), 0);
  }
  place(scene, std::move(sheets));
  add_test_ground(scene);
  return scene;
}

Scene make_disk_scene(const ProceduralParameters& parameters) {
  Scene scene;
  scene.materials.push_back(blend_material("disk", parameters.real("opacity")));
  const std::uint32_t segments = parameters.whole("segments");
  const float radius = parameters.real("radius");
  const float height = parameters.real("height");
  Mesh disk;
  disk.name = "disk";
  disk.positions.emplace_back(0.0f, height, 0.0f);
  for (std::uint32_t i = 0; i < segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / segments;
    disk.positions.emplace_back(radius * static_cast<float>(std::cos(angle)), height,
                                -radius * static_cast<float>(std::sin(angle)));
    disk.indices.insert(disk.indices.end(), {0, 1 + i, 1 + (i + 1) % segments});
    disk.materials.push_back(0);
  }
  place(scene, std::move(disk));
  add_test_ground(scene);
  return scene;
}

Scene make_cube_scene(const ProceduralParameters& parameters) {
  Scene scene;
  scene.materials.push_back(opaque_material("cube"));
  Mesh cube;
  cube.name = "cube";
  const int divisions = static_cast<int>(parameters.whole("divisions"));
  for (int axis = 0; axis < 3; ++axis) {
    V3f out(0, 0, 0);
    out[axis] = 1;
    append_cube_face(cube, out, divisions);
    append_cube_face(cube, -out, divisions);
  }
  for (V3f& position : cube.positions) position.y += 0.5f;
  place(scene, std::move(cube));
  return scene;
}

Scene make_sieve_scene(const ProceduralParameters& parameters) {
  const std::uint32_t holes = parameters.whole("holes");
  const float height = parameters.real("height"), half = 0.5f * std::sqrt(parameters.real("open"));
  const float cell = kSheetSide / static_cast<float>(holes);
  Mesh plate;
  plate.name = "sieve";
  // Corners of a cell and of its hole, at the same angles.
  constexpr V2f kCorners[4] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
  for (std::uint32_t i = 0; i < holes * holes; ++i) {
    const V2f centre((static_cast<float>(i % holes) + 0.5f) * cell - kSheetSide / 2,
                     (static_cast<float>(i / holes) + 0.5f) * cell - kSheetSide / 2);
    const auto corner = [&](int k, float size) {
      const V2f at = centre + kCorners[k % 4] * (size * cell);
      return V3f(at.x, height, at.y);
    };
    for (int k = 0; k < 4; ++k)
      append_quad(plate, corner(k, 0.5f), corner(k + 1, 0.5f), corner(k + 1, half), corner(k, half),
                  0);
  }
  Scene scene;
  scene.materials = {opaque_material("plate")};
  place(scene, std::move(plate));
  add_test_ground(scene);
  return scene;
}

Scene make_greys_scene(const ProceduralParameters& parameters) {
  Scene scene;
  scene.materials = {blend_material("quarter", 0.25f), blend_material("half", 0.5f)};
  const float gap = parameters.real("gap");
  Mesh sheets;
  sheets.name = "greys";
  append_square(sheets, kSheetSide, gap, 0);
  append_square(sheets, kSheetSide, 2 * gap, 1);
  place(scene, std::move(sheets));
  add_test_ground(scene);
  return scene;
}

}  // namespace dapple
