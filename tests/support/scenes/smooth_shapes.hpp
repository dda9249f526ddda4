// Closed surfaces with smooth normals, as modelling programs write them, and other meshes with
// normals, for tests of shading.
#pragma once

#include <cmath>
#include <numbers>

#include "dapple/scene.hpp"

namespace dapple::test {

/// Normals at vertices: means of the triangles around them, by area.
inline void set_smooth_normals(Mesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), V3f(0, 0, 0));
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const std::uint32_t* corner = &mesh.indices[3 * t];
    const V3f& a = mesh.positions[corner[0]];
    const V3f area = (mesh.positions[corner[1]] - a).cross(mesh.positions[corner[2]] - a);
    for (int k = 0; k < 3; ++k) mesh.normals[corner[k]] += area;
  }
  for (V3f& normal : mesh.normals) normal.normalize();
}

/// A scene of one opaque mesh, placed once.
inline Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.source = "a test";
  scene.materials.resize(1);
  mesh.materials.assign(mesh.indices.size() / 3, 0);
  scene.meshes.push_back(std::move(mesh));
  scene.instances.resize(1);
  return scene;
}

/// A grid of `columns` times `rows` quads whose last columns join the first ones; rows too if
/// `closed_rows`. `vertex(u, v)` appends a vertex, u and v in [0, 1].
template <class Vertex>
Mesh wrapped_grid(int columns, int rows, bool closed_rows, const Vertex& vertex) {
  Mesh mesh;
  const int lines = closed_rows ? rows : rows + 1;
  for (int row = 0; row < lines; ++row)
    for (int column = 0; column < columns; ++column)
      vertex(mesh, static_cast<double>(column) / columns, static_cast<double>(row) / rows);
  const auto index = [&](int column, int row) {
    return static_cast<std::uint32_t>(row % lines * columns + column % columns);
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t a = index(column, row), b = index(column + 1, row),
                          c = index(column, row + 1), d = index(column + 1, row + 1);
      if (closed_rows || row > 0) mesh.indices.insert(mesh.indices.end(), {a, b, c});
      if (closed_rows || row + 1 < rows) mesh.indices.insert(mesh.indices.end(), {b, d, c});
    }
  }
  return mesh;
}

/// A sphere of radius 1 around the origin; 21 by 13 quads are 504 triangles.
inline Mesh smooth_sphere(int columns = 21, int rows = 13) {
  return wrapped_grid(columns, rows, false, [](Mesh& mesh, double u, double v) {
    const double around = 2 * std::numbers::pi * u, down = std::numbers::pi * v;
    const V3d normal(std::sin(down) * std::cos(around), std::cos(down),
                     std::sin(down) * std::sin(around));
    mesh.positions.emplace_back(normal);
    mesh.normals.emplace_back(normal);
  });
}

/// A torus of radii 1 and 0.4 that lies flat.
inline Scene smooth_torus(int columns, int rows) {
  return scene_of(wrapped_grid(columns, rows, true, [](Mesh& mesh, double u, double v) {
    const double around = 2 * std::numbers::pi * u, across = 2 * std::numbers::pi * v;
    const V3d out(std::cos(around), 0, std::sin(around));
    const V3d normal = out * std::cos(across) + V3d(0, 1, 0) * std::sin(across);
    mesh.positions.emplace_back(out + normal * 0.4);
    mesh.normals.emplace_back(normal);
  }));
}

}  // namespace dapple::test
