#include "scene/check/scene_check.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dapple/error.hpp"
#include "scene/check/enumerator.hpp"
#include "scene/check/finite.hpp"
#include "scene/check/numeric_range.hpp"
#include "scene/message.hpp"

namespace dapple {
namespace {

/// Refuses parts of a scene; messages begin with what the part is called.
class Check {
 public:
  Check(const Scene& scene, const char* what, std::size_t number, const std::string& name)
      : scene_(scene), what_(what), number_(number), name_(name) {}

  template <class... Values>
  void that(bool holds, fmt::format_string<Values...> otherwise, Values&&... values) const {
    if (holds) return;
    const std::string name = name_.empty() ? "" : fmt::format(" \"{:.100}\"", name_);
    throw Error(ErrorKind::input,
                one_line(fmt::format("{}{}{} {}{} {}", scene_.source,
                                     scene_.source.empty() ? "" : ": ", what_, number_, name,
                                     fmt::format(otherwise, std::forward<Values>(values)...))));
  }
  /// An optional array has no elements, or one for each of `count`.
  template <class T>
  void length(const char* array, const std::vector<T>& values, std::size_t count) const {
    that(values.empty() || values.size() == count, "has {} {}; it must have {}, or none",
         values.size(), array, count);
  }

 private:
  const Scene& scene_;
  const char* what_;
  std::size_t number_;
  const std::string& name_;
};

std::uint32_t largest(const std::vector<std::uint32_t>& values) {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_reduce(
      Range(0, values.size(), 1u << 16), 0u,
      [&](const Range& range, std::uint32_t most) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) most = std::max(most, values[i]);
        return most;
      },
      [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); });
}

void check_indices(const Check& check, const char* of, const std::vector<std::uint32_t>& indices,
                   std::size_t count) {
  if (indices.empty()) return;
  const std::uint32_t most = largest(indices);
  check.that(most < count, "has the {} {}, but there are {}", of, most, count);
}

void check_mesh(const Scene& scene, std::size_t number) {
  const Mesh& mesh = scene.meshes[number];
  const Check check(scene, "mesh", number, mesh.name);
  const std::size_t corners = mesh.has_strands() ? 2 : 3, vertices = mesh.positions.size();
  check.that(mesh.indices.size() == corners * mesh.materials.size(),
             "has {} indices and {} materials; each material is of {} indices", mesh.indices.size(),
             mesh.materials.size(), corners);
  check_indices(check, "index", mesh.indices, vertices);
  check_indices(check, "material", mesh.materials, scene.materials.size());
  check.length("radii", mesh.radii, vertices);
  check.length("normals", mesh.normals, vertices);
  check.length("uvs", mesh.uvs, vertices);
  check.length("colors", mesh.colors, vertices);
  check.length("vertex_alpha", mesh.vertex_alpha, vertices);
  check.that(std::all_of(mesh.vertex_alpha.begin(), mesh.vertex_alpha.end(),
                         [](float alpha) { return std::isfinite(alpha); }),
             "has a vertex_alpha that is not finite");
  check.length("objects", mesh.objects, mesh.materials.size());
  check_indices(check, "object", mesh.objects, scene.objects.size());
}

bool is_color(const V3f& v) { return is_finite(v) && std::min({v.x, v.y, v.z}) >= 0; }

bool is_radiance(const V3f& v) {
  return is_color(v) && std::max({v.x, v.y, v.z}) <= static_cast<float>(kLargestRadiance);
}

/// -1 is none.
bool is_index(int index, std::size_t count) {
  return index >= -1 && (index < 0 || static_cast<std::size_t>(index) < count);
}

void check_material(const Scene& scene, std::size_t number) {
  const Material& material = scene.materials[number];
  const Check check(scene, "material", number, material.name);
  check.that(is_enumerator(material.alpha_mode, AlphaMode::blend), "has no alpha mode {}",
             static_cast<int>(material.alpha_mode));
  check.that(is_index(material.alpha_texture, scene.textures.size()), "has no texture {}",
             material.alpha_texture);
  check.that(is_index(material.color_texture, scene.color_textures.size()),
             "has no colour texture {}", material.color_texture);
  check.that(std::isfinite(material.alpha) && std::isfinite(material.alpha_cutoff),
             "has the alpha {} and the cutoff {}", material.alpha, material.alpha_cutoff);
  check.that(is_color(material.color), "has a colour that is negative or not finite");
}

template <class Image>
void check_image(const Scene& scene, const char* what, std::size_t number, const Image& image,
                 std::size_t values, std::size_t channels) {
  const Check check(scene, what, number, image.name);
  const std::size_t texels = std::size_t{image.width} * image.height;
  check.that(texels > 0 && values == channels * texels, "has {} values for {} x {} texels", values,
             image.width, image.height);
  check.that(is_enumerator(image.wrap_s, Wrap::mirror) && is_enumerator(image.wrap_t, Wrap::mirror),
             "has the wrap modes {} and {}, which there are not", static_cast<int>(image.wrap_s),
             static_cast<int>(image.wrap_t));
}

void check_images(const Scene& scene) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i)
    check_image(scene, "texture", i, scene.textures[i], scene.textures[i].alpha.size(), 1);
  for (std::size_t i = 0; i < scene.color_textures.size(); ++i) {
    const ColorTexture& image = scene.color_textures[i];
    check_image(scene, "colour texture", i, image, image.rgb.size(), 3);
    if (!image.alpha.empty()) check_image(scene, "colour texture", i, image, image.alpha.size(), 1);
  }
}

void check_light(const Scene& scene, std::size_t number) {
  const Light& light = scene.lights[number];
  const Check check(scene, "light", number, light.name);
  check.that(is_radiance(light.radiance),
             "has a radiance that is negative, not finite or above {:g}", kLargestRadiance);
  const LightKind kind = light.kind;
  check.that(is_enumerator(kind, LightKind::disk), "has no kind {}", static_cast<int>(kind));
  check.that(std::isfinite(light.rotation), "has the rotation {}", light.rotation);
  check.that(light.cos_outer >= -1 && light.cos_outer <= light.cos_inner && light.cos_inner <= 1,
             "has a cone of the cosines {} inside and {} outside", light.cos_inner,
             light.cos_outer);
  if (const Environment* dome = light.environment.get()) {
    check.that(
        !dome->radiance.empty() && dome->radiance.size() == std::size_t{dome->width} * dome->height,
        "has a dome of {} values for {} x {} pixels; they must be as many, and one at least",
        dome->radiance.size(), dome->width, dome->height);
    check.that(std::all_of(dome->radiance.begin(), dome->radiance.end(), is_radiance),
               "has a dome with pixels that are negative, not finite or above {:g}",
               kLargestRadiance);
  }
  if (kind == LightKind::mesh || kind == LightKind::dome) return;
  check.that(is_finite(light.position), "has a position that is not finite");
  const bool is_spot = light.cos_outer > -1;
  check.that(
      (kind == LightKind::sphere && !is_spot) || std::fabs(light.direction.length() - 1) < 1e-3f,
      "has a direction that is not unit");
  if (kind == LightKind::sphere || kind == LightKind::disk)
    check.that(light.radius > 0 && std::isfinite(light.radius), "has the radius {}", light.radius);
  if (kind == LightKind::sun)
    check.that(light.angular_radius > 0 && light.angular_radius < std::numbers::pi_v<float>,
               "has the angular radius {}; it must be above 0 and below pi", light.angular_radius);
  if (kind == LightKind::rect)
    check.that(is_finite(light.edge_u) && is_finite(light.edge_v),
               "has an edge that is not finite");
}

}  // namespace

void check_lights(const Scene& scene) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) check_light(scene, i);
}

void check_scene(const Scene& scene) {
  check_geometry(scene);
  check_lights(scene);
}

void check_geometry(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) check_mesh(scene, i);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) check_material(scene, i);
  check_images(scene);
  static const std::string no_name;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Check check(scene, "instance", i, no_name);
    check.that(instance.mesh < scene.meshes.size(), "has no mesh {}", instance.mesh);
    check.that(is_index(instance.light, scene.lights.size()), "has no light {}", instance.light);
    check.that(instance.object < 0 || is_index(instance.object, scene.objects.size()),
               "has no object {}", instance.object);
  }
}

}  // namespace dapple
