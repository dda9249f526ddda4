#include "oracle/oracle_primitives.hpp"

#include <algorithm>
#include <cmath>

namespace dapple::oracle {
namespace {

std::int64_t remainder(std::int64_t value, std::int64_t modulus) {
  const std::int64_t r = value % modulus;
  return r < 0 ? r + modulus : r;
}

/// Wrap modes of the OpenGL 4.6 specification, section 8.14.2, table 8.21, to which glTF's samplers
/// refer.
std::size_t wrapped(std::int64_t i, std::int64_t size, Wrap wrap) {
  const auto mirror = [](std::int64_t a) { return a >= 0 ? a : -(1 + a); };
  switch (wrap) {
    case Wrap::repeat:
      i = remainder(i, size);
      break;
    case Wrap::clamp:
      i = std::clamp<std::int64_t>(i, 0, size - 1);
      break;
    case Wrap::mirror:
      i = (size - 1) - mirror(remainder(i, 2 * size) - size);
      break;
  }
  return static_cast<std::size_t>(i);
}

double texel(const Texture& texture, std::int64_t column, std::int64_t row) {
  const std::size_t x = wrapped(column, texture.width, texture.wrap_s);
  const std::size_t y = wrapped(row, texture.height, texture.wrap_t);
  return texture.alpha[y * texture.width + x] / 255.0;
}

double texture_alpha(const Texture& texture, const Imath::V2d& uv) {
  const double x = uv.x * texture.width;
  const double y = uv.y * texture.height;
  const auto cell = [](double a) { return static_cast<std::int64_t>(std::floor(a)); };
  if (texture.nearest) return texel(texture, cell(x), cell(y));
  const std::int64_t column = cell(x - 0.5);
  const std::int64_t row = cell(y - 0.5);
  double alpha = 0;
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const double share_x = 1 - std::fabs(x - 0.5 - static_cast<double>(column + dx));
      const double share_y = 1 - std::fabs(y - 0.5 - static_cast<double>(row + dy));
      alpha += share_x * share_y * texel(texture, column + dx, row + dy);
    }
  }
  return alpha;
}

double opacity_of(double alpha, const Material& material) {
  switch (material.alpha_mode) {
    case AlphaMode::opaque:
      return 1;
    case AlphaMode::mask:
      return alpha >= material.alpha_cutoff ? 1 : 0;
    case AlphaMode::blend:
      break;
  }
  return alpha;
}

Triangle place(const Mesh& mesh, std::size_t index, const Instance& instance) {
  const Imath::M44d to_world(instance.to_world);
  Triangle triangle{};
  triangle.material = mesh.materials[index];
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = mesh.indices[3 * index + k];
    triangle.corner[k] = V3f(V3d(mesh.positions[vertex]) * to_world);
    if (!mesh.uvs.empty()) triangle.uv[k] = Imath::V2d(mesh.uvs[vertex]);
    if (!mesh.normals.empty()) {
      V3d normal;
      to_world.inverse().transposed().multDirMatrix(V3d(mesh.normals[vertex]), normal);
      triangle.normal[k] = normal.normalized();
    }
    triangle.vertex_alpha[k] = mesh.vertex_alpha.empty() ? 1.0 : mesh.vertex_alpha[vertex];
  }
  return triangle;
}

std::vector<Triangle> flatten(const Scene& scene) {
  std::vector<Triangle> triangles;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (std::size_t i = 0; !mesh.has_strands() && i < mesh.primitive_count(); ++i) {
      triangles.push_back(place(mesh, i, instance));
    }
  }
  return triangles;
}

std::vector<Curve> flatten_strands(const Scene& scene) {
  std::vector<Curve> curves;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const Imath::M44d to_world(instance.to_world);
    const double scale = std::cbrt(std::fabs(to_world.determinant()));
    for (std::size_t i = 0; mesh.has_strands() && i < mesh.primitive_count(); ++i) {
      const std::uint32_t* at = &mesh.indices[2 * i];
      Curve curve{};
      for (int k = 0; k < 2; ++k) {
        curve.end[k] = V3f(V3d(mesh.positions[at[k]]) * to_world);
        curve.radius[k] = static_cast<float>(mesh.radii[at[k]] * scale);
        curve.vertex_alpha += mesh.vertex_alpha.empty() ? 0.5 : 0.5 * mesh.vertex_alpha[at[k]];
      }
      curve.material = mesh.materials[i];
      curve.goes_on = i + 1 < mesh.primitive_count() && at[1] == at[2];
      curves.push_back(curve);
    }
  }
  return curves;
}

}  // namespace

V3d normal_of(const Triangle& triangle) {
  const V3d a(triangle.corner[0]), b(triangle.corner[1]), c(triangle.corner[2]);
  return (b - a).cross(c - a);
}

/// The weights from the areas of the three triangles that the hit point forms with the edges.
Weights weights_at(const Triangle& triangle, const V3d& origin, const V3d& direction) {
  const V3d normal = normal_of(triangle);
  const V3d corner[3] = {V3d(triangle.corner[0]), V3d(triangle.corner[1]), V3d(triangle.corner[2])};
  const double t = (corner[0] - origin).dot(normal) / direction.dot(normal);
  const V3d point = origin + direction * t;
  Weights weights{};
  for (int k = 0; k < 3; ++k) {
    const V3d& from = corner[(k + 1) % 3];
    const V3d& to = corner[(k + 2) % 3];
    weights.of[k] = (to - from).cross(point - from).dot(normal) / normal.length2();
  }
  return weights;
}

Primitives::Primitives(const Scene& scene)
    : triangles(flatten(scene)),
      curves(flatten_strands(scene)),
      materials(scene.materials),
      textures(scene.textures) {}

double Primitives::opacity(unsigned primitive, const Segment& segment) const {
  if (primitive >= triangles.size()) {
    const Curve& curve = curves[primitive - triangles.size()];
    const Material& material = materials[curve.material];
    return opacity_of(material.alpha * (material.uses_vertex_alpha ? curve.vertex_alpha : 1.0),
                      material);
  }
  const Triangle& triangle = triangles[primitive];
  const Material& material = materials[triangle.material];
  const Weights weights = weights_at(triangle, V3d(segment.origin), V3d(segment.direction));
  double alpha = material.alpha;
  if (material.uses_vertex_alpha) alpha *= interpolate(weights, triangle.vertex_alpha);
  if (material.alpha_texture >= 0) {
    alpha *= texture_alpha(textures[static_cast<std::size_t>(material.alpha_texture)],
                           interpolate(weights, triangle.uv));
  }
  return opacity_of(alpha, material);
}

}  // namespace dapple::oracle
