#include "render/render_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "dapple/error.hpp"
#include "device/programs/kernel_source.hpp"
#include "files/checksum.hpp"

namespace dapple {
namespace {

std::string passes_text(const RenderOptions& options) {
  // Visits are counted with and without the pass, so it is not a setting.
  std::vector<std::string> names;
  if (options.ao) names.emplace_back("ao");
  if (options.light) names.emplace_back("light");
  if (options.albedo) names.emplace_back("albedo");
  if (options.back) names.emplace_back("back");
  if (options.motion) names.emplace_back("motion");
  return fmt::format("{}", fmt::join(names, ","));
}

void add_matrix(ChecksumStream& stream, const M44f& matrix) {
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) stream.add_value(matrix[row][column]);
}

std::string camera_checksum(const Camera& camera) {
  ChecksumStream stream;
  stream.add_value(camera.kind);
  add_matrix(stream, camera.to_world);
  stream.add_value(camera.fov_y);
  stream.add_value(camera.half_height);
  stream.add_value(camera.lens_radius);
  stream.add_value(camera.focus_distance);
  return hex_text(stream.value());
}

/// The scene as rays intersect it, with overridden opacities and ground.
std::string scene_checksum(const SceneBvh& bvh, const DeviceBuffers& scene) {
  ChecksumStream stream;
  stream.add_range(bvh.nodes);
  stream.add_range(bvh.blocks);
  stream.add_range(bvh.segments);
  stream.add_range(bvh.textured);
  stream.add_range(bvh.instances);
  stream.add_range(scene.material_records);
  stream.add_range(scene.texel_data);
  stream.add_range(scene.corner_normals);
  stream.add_range(scene.colors.words);
  stream.add_range(scene.colors.materials);
  stream.add_range(scene.colors.texels);
  stream.add_value(bvh.root);
  for (int axis = 0; axis < 3; ++axis) {
    stream.add_value(bvh.bounds.min[axis]);
    stream.add_value(bvh.bounds.max[axis]);
  }
  return hex_text(stream.value());
}

/// Not of radiances, which the sums are multiplied by afterwards; but dark lights have no sums.
std::string light_checksum(const DeviceBuffers& scene) {
  ChecksumStream stream;
  for (const bool dark : scene.dark_lights) stream.add_value(dark);
  stream.add_range(scene.light_records);
  stream.add_range(scene.emitter_triangles);
  stream.add_range(scene.environment_data);
  return hex_text(stream.value());
}

bool is_checksum(const std::string& value) {
  return value.size() == 32 && value.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// "2/8 of --spp 64": with other sample counts it would be other samples.
std::string shard_text(const RenderOptions& options) {
  const Shard& shard = options.shard;
  if (shard.count == 1) return "1/1";
  return fmt::format("{}/{} of --spp {}", shard.index, shard.count, options.spp);
}

}  // namespace

Settings option_settings(const RenderOptions& options, const View& view) {
  const auto number = [](auto value) { return fmt::format("{}", value); };
  const PixelRect& crop = view.crop;
  return {
      {"--width", number(options.width)},
      {"--height", number(options.height)},
      {"--crop", fmt::format("{},{},{},{}", crop.x0, crop.y0, crop.x1, crop.y1)},
      {"--shard", shard_text(options)},
      {"--seed", number(options.seed)},
      {"--estimator", name_of(options.estimator)},
      {"--packets", name_of(options.packets)},
      {"--footprint", number(options.footprint)},
      {"--roulette", number(options.roulette)},
      {"--max-bias", number(options.max_bias.value_or(0.0f))},
      {"--normals", name_of(options.normals)},
      {"--passes", passes_text(options)},
      {"--camera-splitting", number(options.camera_splitting)},
      {"--ao-rays", number(options.ao_rays)},
      {"--light-rays", number(options.light_rays)},
      {"--back-every", options.back ? number(options.back_every) : "none"},
      {"--ao-distance", number(options.ao_distance)},
      {"--ao-falloff", number(options.ao_falloff)},
      {"--cryptomatte", name_of(options.cryptomattes)},
      {"--target-error or --target-rmse", is_adaptive(options) ? "a value" : "none"},
  };
}

Settings content_settings(const RenderOptions& options, const View& view, const SceneBvh& bvh,
                          const DeviceBuffers& scene) {
  return {
      {"scene, --opacity or --ground", scene_checksum(bvh, scene)},
      {"camera", camera_checksum(view.camera)},
      {"lights", options.light ? light_checksum(scene) : "none"},
      {"version of dapple", DAPPLE_VERSION},
      {"kernels", kernel_checksum(options.kernel_dir)},
  };
}

std::string text_checksum(const std::vector<std::string>& texts) {
  ChecksumStream stream;
  for (const std::string& text : texts) {
    stream.add_value(text.size());
    stream.add_range(text);
  }
  return hex_text(stream.value());
}

std::string pose_checksum(const Scene& scene) {
  ChecksumStream stream;
  for (const Mesh& mesh : scene.meshes) stream.add_range(mesh.positions);
  for (const Instance& instance : scene.instances) add_matrix(stream, instance.to_world);
  for (const Camera& camera : scene.cameras) add_matrix(stream, camera.to_world);
  return hex_text(stream.value());
}

bool Difference::is_opaque() const { return is_checksum(before) || is_checksum(now); }

std::optional<Difference> first_difference(const Settings& then, const Settings& now) {
  std::map<std::string, int> seen;  // settings of one name so far
  for (const auto& asked : now) {
    const std::string &name = asked.first, &value = asked.second;  // clang 14 captures no bindings
    int number = seen[name]++;
    const auto found = std::find_if(then.begin(), then.end(), [&](const auto& setting) {
      return setting.first == name && number-- == 0;
    });
    const std::string before = found == then.end() ? "none" : found->second;
    if (before != value) return Difference{name, before, value};
  }
  return {};
}

void require_same(const std::string& path, const Settings& then, const Settings& now) {
  const auto other = first_difference(then, now);
  if (!other) return;
  throw Error(ErrorKind::usage,
              other->is_opaque()
                  ? fmt::format("--resume {}: differs from this run in {}", path, other->name)
                  : fmt::format("--resume {}: was made with {} {}, this run has {} {}", path,
                                other->name, other->before, other->name, other->now));
}

}  // namespace dapple
