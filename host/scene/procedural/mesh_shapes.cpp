// Appends quads, squares, tubes and leaf blades to a mesh: see mesh_shapes.hpp.
#include "scene/procedural/mesh_shapes.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace dapple {
namespace {

void append_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                     std::uint32_t material) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c});
  mesh.materials.push_back(material);
}

std::uint32_t next_vertex(const Mesh& mesh) {
  return static_cast<std::uint32_t>(mesh.positions.size());
}

/// Adds zero normals, which stand for those of the faces, for new vertices of a mesh with normals.
void complete_normals(Mesh& mesh) {
  if (!mesh.normals.empty()) mesh.normals.resize(mesh.positions.size(), V3f(0, 0, 0));
}

/// `u` and `v`: unit, at right angles to each other.
void append_ring(Mesh& mesh, V3f centre, float radius, V3f u, V3f v, int sides) {
  for (int i = 0; i < sides; ++i) {
    // Double arithmetic, rounded at the end: differences in libm's last bit do not change the mesh.
    const double angle = 2 * std::numbers::pi * i / sides;
    const auto x = static_cast<float>(std::cos(angle)), y = static_cast<float>(std::sin(angle));
    mesh.positions.push_back(centre + u * radius * x + v * radius * y);
    if (sides >= kSmoothSides) mesh.normals.push_back(u * x + v * y);
  }
}

void join_rings(Mesh& mesh, std::uint32_t lower, std::uint32_t upper, int sides,
                std::uint32_t material) {
  for (int i = 0; i < sides; ++i) {
    const auto here = static_cast<std::uint32_t>(i);
    const auto next = static_cast<std::uint32_t>((i + 1) % sides);
    append_triangle(mesh, lower + here, upper + next, lower + next, material);
    append_triangle(mesh, lower + here, upper + here, upper + next, material);
  }
}

void close_ring(Mesh& mesh, std::uint32_t ring, V3f apex, int sides, std::uint32_t material) {
  const std::uint32_t top = next_vertex(mesh);
  mesh.positions.push_back(apex);
  for (int i = 0; i < sides; ++i) {
    append_triangle(mesh, ring + static_cast<std::uint32_t>(i), top,
                    ring + static_cast<std::uint32_t>((i + 1) % sides), material);
  }
}

}  // namespace

V3f perpendicular(V3f direction) {
  const bool steep = std::abs(direction.y) > std::abs(direction.x);
  return direction.cross(steep ? V3f(1, 0, 0) : V3f(0, 1, 0)).normalized();
}

void append_quad(Mesh& mesh, V3f a, V3f b, V3f c, V3f d, std::uint32_t material) {
  const std::uint32_t first = next_vertex(mesh);
  mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
  complete_normals(mesh);
  append_triangle(mesh, first, first + 1, first + 2, material);
  append_triangle(mesh, first, first + 2, first + 3, material);
}

void append_square(Mesh& mesh, float side, float y, std::uint32_t material) {
  const float h = side / 2;
  append_quad(mesh, {-h, y, h}, {h, y, h}, {h, y, -h}, {-h, y, -h}, material);
}

void append_tube(Mesh& mesh, std::span<const V3f> points, std::span<const float> radii, int sides,
                 std::uint32_t material) {
  assert(points.size() >= 2 && points.size() == radii.size() && sides >= 3);
  const bool is_smooth = sides >= kSmoothSides;
  if (is_smooth) mesh.normals.resize(mesh.positions.size(), V3f(0, 0, 0));
  const std::size_t last = points.size() - 1;
  V3f u = perpendicular(points[1] - points[0]);
  std::uint32_t lower = 0;
  for (std::size_t i = 0; i < last; ++i) {
    const V3f along = (points[i + 1] - points[i == 0 ? 0 : i - 1]).normalized();
    // The ring moves without rotating about the axis, so that the tube does not twist. Where `u`
    // is parallel to the path, a new direction is taken.
    const V3f carried = u - along * u.dot(along);
    u = carried.length2() > 1e-6f ? carried.normalized() : perpendicular(along);
    const std::uint32_t ring = next_vertex(mesh);
    append_ring(mesh, points[i], radii[i], u, -along.cross(u), sides);
    if (i > 0) join_rings(mesh, lower, ring, sides, material);
    lower = ring;
  }
  close_ring(mesh, lower, points[last], sides, material);
  if (is_smooth) mesh.normals.push_back((points[last] - points[last - 1]).normalized());
  complete_normals(mesh);
}

void append_grid_triangles(Mesh& mesh, std::uint32_t first, int rows, int columns,
                           std::uint32_t material) {
  const auto pitch = static_cast<std::uint32_t>(columns + 1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t here =
          first + static_cast<std::uint32_t>(row) * pitch + static_cast<std::uint32_t>(column);
      append_triangle(mesh, here, here + 1, here + pitch + 1, material);
      append_triangle(mesh, here, here + pitch + 1, here + pitch, material);
    }
  }
}

void smooth_normals(Mesh& mesh, std::size_t first_vertex, std::size_t first_triangle) {
  mesh.normals.resize(mesh.positions.size(), V3f(0, 0, 0));
  for (std::size_t v = first_vertex; v < mesh.normals.size(); ++v) mesh.normals[v] = V3f(0, 0, 0);
  for (std::size_t t = first_triangle; t < mesh.materials.size(); ++t) {
    const std::uint32_t* const corner = &mesh.indices[3 * t];
    const V3f a = mesh.positions[corner[0]];
    const V3f area = (mesh.positions[corner[1]] - a).cross(mesh.positions[corner[2]] - a);
    for (int k = 0; k < 3; ++k) mesh.normals[corner[k]] += area;
  }
  for (std::size_t v = first_vertex; v < mesh.normals.size(); ++v)
    mesh.normals[v] = mesh.normals[v].normalized();
}

V2f spiral_azimuth(int i, float offset) {
  const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0)) + double{offset};
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

BladeRange::BladeRange(Mesh& mesh, std::size_t count, std::uint32_t material)
    : mesh_(mesh),
      first_vertex_(mesh.positions.size()),
      first_triangle_(mesh.materials.size()),
      material_(material) {
  mesh.positions.resize(first_vertex_ + 4 * count);
  complete_normals(mesh);
  mesh.materials.resize(first_triangle_ + 2 * count);
  mesh.indices.resize(3 * mesh.materials.size());
}

void BladeRange::set(std::size_t i, const Blade& blade) {
  const V3f side = blade.axis.cross(blade.normal) * (blade.length * blade.width / 2);
  const V3f middle =
      blade.base + blade.axis * (blade.length * 0.45f) + blade.normal * (blade.length * 0.06f);
  V3f* const corner = &mesh_.positions[first_vertex_ + 4 * i];
  corner[0] = blade.base;
  corner[1] = middle + side;
  corner[2] = blade.base + blade.axis * blade.length;
  corner[3] = middle - side;

  const auto v = static_cast<std::uint32_t>(first_vertex_ + 4 * i);
  const std::size_t triangle = first_triangle_ + 2 * i;
  std::uint32_t* const index = &mesh_.indices[3 * triangle];
  const std::uint32_t blade_indices[6] = {v, v + 1, v + 2, v, v + 2, v + 3};
  for (int k = 0; k < 6; ++k) index[k] = blade_indices[k];
  mesh_.materials[triangle] = material_;
  mesh_.materials[triangle + 1] = material_;
}

}  // namespace dapple
