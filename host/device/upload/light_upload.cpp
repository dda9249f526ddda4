#include "device/upload/light_upload.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <unordered_map>

#include "bvh/opacity/texture_integrals.hpp"
#include "bvh/opacity/triangle_opacity.hpp"
#include "dapple/error.hpp"
#include "device/upload/emitter_tree.hpp"
#include "device/upload/stored_vector.hpp"
#include "scene/lights/rect_axes.hpp"

namespace dapple {
namespace {

/// Parts of equal size that a textured triangle's opacity is looked up in: squares of these
/// numbers.
constexpr std::size_t kMostDivisions = 16, kMostLookups = 1u << 22;

/// The mean opacity of each triangle: what is cut out or transparent does not shine.
std::vector<float> mean_opacities(const Scene& scene, const OpaqueTexels& texels,
                                  SharedMipLevels& mip_levels, const Mesh& mesh) {
  std::vector<float> opacities;
  std::vector<TexturedTriangle> textured;
  for (std::uint32_t t = 0; t < mesh.primitive_count(); ++t) {
    const std::optional<float> uniform = uniform_opacity(scene, texels, mesh, t);
    if (!uniform) textured.push_back(textured_triangle(scene, mesh, t, true));
    opacities.push_back(uniform.value_or(-1));
  }
  if (textured.empty()) return opacities;
  const TextureIntegrals integrals(scene, textured, mip_levels);
  const auto affordable = static_cast<std::size_t>(
      std::sqrt(static_cast<double>(kMostLookups) / static_cast<double>(textured.size())));
  const std::size_t divisions = std::clamp<std::size_t>(affordable, 1, kMostDivisions);
  auto next = textured.begin();
  for (float& opacity : opacities)
    if (opacity < 0) opacity = integrals.of(*next++).mean_of_parts(divisions);
  return opacities;
}

/// The triangles of `instance` whose `opacities` leave them light. Appends them to `triangles`.
/// Returns their area in m^2, times their opacities.
double append_instance(const Instance& instance, const Mesh& mesh,
                       const std::vector<float>& opacities,
                       std::vector<EmitterTriangle>& triangles) {
  // A mirrored instance reverses the winding of its triangles. The swapped edges keep the normal on
  // the front face, as glTF defines it.
  const bool mirrored = Imath::M44d(instance.to_world).determinant() < 0;
  double total = 0;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const auto corner = [&](int c) {
      return mesh.positions[mesh.indices[3 * t + c]] * instance.to_world;
    };
    const V3f vertex = corner(0);
    const V3f edge1 = corner(1) - vertex, edge2 = corner(2) - vertex;
    const double area = 0.5 * edge1.cross(edge2).length() * double{opacities[t]};
    if (!(area > 0)) continue;
    EmitterTriangle triangle{};
    store(vertex, triangle.vertex);
    triangle.area = static_cast<float>(area);
    store(mirrored ? edge2 : edge1, triangle.edge1);
    store(mirrored ? edge1 : edge2, triangle.edge2);
    triangles.push_back(triangle);
    total += area;
  }
  return total;
}

/// The triangles of mesh lights.
class Emitters {
 public:
  explicit Emitters(const Scene& scene) : scene_(scene), of_lights_(scene.lights.size()) {
    for (const Instance& instance : scene.instances) {
      const auto light = static_cast<std::size_t>(instance.light);
      if (instance.light >= 0 && light < of_lights_.size()) of_lights_[light].push_back(&instance);
    }
  }

  /// Appends the triangles of every instance that emits for `light`. Returns the area in m^2 that
  /// shines.
  double append(std::size_t light, std::vector<EmitterTriangle>& emitters) {
    std::vector<EmitterTriangle> of_light;
    double total = 0;
    for (const Instance* instance : of_lights_[light]) {
      const Mesh& mesh = scene_.meshes[instance->mesh];
      if (mesh.has_strands()) continue;
      total += append_instance(*instance, mesh, opacities_of(instance->mesh), of_light);
    }
    if (of_light.empty()) of_light.push_back({});  // kernels expect one; this one gives no light
    divide_long_emitters(of_light);
    order_emitters(of_light);
    emitters.insert(emitters.end(), of_light.begin(), of_light.end());
    return total;
  }

 private:
  /// Found once for each mesh: many lamps may be instances of one.
  const std::vector<float>& opacities_of(std::uint32_t mesh) {
    const auto [at, is_new] = opacities_.try_emplace(mesh);
    if (is_new) at->second = mean_opacities(scene_, texels_, mip_levels_, scene_.meshes[mesh]);
    return at->second;
  }

  const Scene& scene_;
  const OpaqueTexels texels_{scene_};
  SharedMipLevels mip_levels_{scene_};
  std::vector<std::vector<const Instance*>> of_lights_;
  std::unordered_map<std::uint32_t, std::vector<float>> opacities_;
};

/// The edges of a rect, the shorter one first, as its kernels take them, and its area.
void store_rect(const Light& light, LightRecord& record) {
  const V3f &u = light.edge_u, &v = light.edge_v, &facing = light.direction;
  const auto are_perpendicular = [](const V3f& a, const V3f& b) {
    constexpr float kTolerance = 1e-5f;  // a hundred roundings
    return std::fabs(a.dot(b)) < kTolerance * a.length() * b.length();
  };
  const bool is_rectangle =
      are_perpendicular(u, v) && are_perpendicular(u, facing) && are_perpendicular(v, facing);
  if (!is_rectangle) record.kind = DAPPLE_LIGHT_PARALLELOGRAM;
  const bool u_is_shorter = u.length2() <= v.length2();
  store(u_is_shorter ? u : v, record.edge_u);
  store(u_is_shorter ? v : u, record.edge_v);
  record.area = u.cross(v).length();
}

/// The axes of a disk, as long as its radius, and its area.
void store_disk(const Light& light, LightRecord& record) {
  const RectAxes axes = rect_axes(light.direction);
  store(axes.u * light.radius, record.edge_u);
  store(axes.v * light.radius, record.edge_v);
  record.area = std::numbers::pi_v<float> * light.radius * light.radius;
}

/// LightRecord::kind, but for parallelograms: store_rect() finds these.
uint kind_of(LightKind kind) {
  switch (kind) {
    case LightKind::rect:
      return DAPPLE_LIGHT_RECT;
    case LightKind::sphere:
      return DAPPLE_LIGHT_SPHERE;
    case LightKind::sun:
      return DAPPLE_LIGHT_SUN;
    case LightKind::mesh:
      return DAPPLE_LIGHT_MESH;
    case LightKind::dome:
      return DAPPLE_LIGHT_DOME;
    case LightKind::disk:
      return DAPPLE_LIGHT_DISK;
  }
  throw Error(ErrorKind::failed, "a light of a kind that kernels do not know");
}

}  // namespace

void pack_lights(const Scene& scene, std::vector<LightRecord>& records,
                 std::vector<EmitterTriangle>& emitters) {
  Emitters meshes(scene);
  int next_sequence = 0;
  for (std::size_t index = 0; index < scene.lights.size(); ++index) {
    const Light& light = scene.lights[index];
    LightRecord record{};
    record.kind = kind_of(light.kind);
    const int sequence = light.sequence >= 0 ? light.sequence : next_sequence;
    next_sequence = std::max(next_sequence, sequence + 1);
    record.sequence = static_cast<uint>(sequence);
    store(light.position, record.position);
    store(light.direction, record.direction);
    record.radius = light.radius;
    const double half = std::sin(0.5 * light.angular_radius);
    record.one_minus_cos = static_cast<float>(2.0 * half * half);
    record.inner_cone = 1.0f - light.cos_inner;
    record.outer_cone = 1.0f - light.cos_outer;
    record.two_sided = light.double_sided ? 1u : 0u;
    if (light.kind == LightKind::rect) store_rect(light, record);
    if (light.kind == LightKind::disk) store_disk(light, record);
    if (light.kind == LightKind::mesh) {
      record.id = static_cast<uint>(index + 1);
      record.first_triangle = static_cast<uint>(emitters.size());
      record.area = static_cast<float>(meshes.append(index, emitters));
      record.triangle_count = static_cast<uint>(emitters.size()) - record.first_triangle;
    }
    records.push_back(record);
  }
}

}  // namespace dapple
