#include "rivals/reference_cache.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "support/fingerprint.hpp"

namespace dapple::bench {
namespace {

/// Must change whenever the reference renderer gives other results.
constexpr int kFormat = 1;

/// A hash of everything that rays can hit and of all lights, since a file of the same name may
/// change.
std::uint64_t content_of(const Scene& scene) {
  Fingerprint print;
  for (const Mesh& mesh : scene.meshes) {
    print.add(mesh.positions);
    print.add(mesh.indices);
    print.add(mesh.materials);
    print.add(mesh.uvs);
    print.add(mesh.vertex_alpha);
    print.add(mesh.radii);
  }
  for (const Texture& texture : scene.textures) {
    print.add(texture.alpha);
    print.add_bytes(&texture.width, sizeof texture.width);
    print.add_bytes(&texture.wrap_s, sizeof texture.wrap_s);
    print.add_bytes(&texture.wrap_t, sizeof texture.wrap_t);
    print.add_bytes(&texture.nearest, sizeof texture.nearest);
  }
  for (const Instance& instance : scene.instances) {
    print.add_bytes(&instance.to_world, sizeof instance.to_world);
    print.add_bytes(&instance.mesh, sizeof instance.mesh);
  }
  for (const Material& material : scene.materials) {
    print.add_bytes(&material.alpha_mode, sizeof material.alpha_mode);
    print.add_bytes(&material.alpha_texture, sizeof material.alpha_texture);
    print.add_bytes(&material.uses_vertex_alpha, sizeof material.uses_vertex_alpha);
    for (const float value : {material.alpha, material.alpha_cutoff})
      print.add_bytes(&value, sizeof value);
  }
  for (const Light& light : scene.lights) {
    print.add_bytes(&light.kind, sizeof light.kind);
    for (const V3f& v : {light.position, light.direction, light.edge_u, light.edge_v})
      print.add_bytes(&v, sizeof v);
    for (const float v : {light.radius, light.angular_radius, light.cos_inner, light.cos_outer})
      print.add_bytes(&v, sizeof v);
  }
  return print.value();
}

std::string file_of(const std::string& folder, const std::string& key) {
  Fingerprint print;
  print.add_bytes(key.data(), key.size());
  return (std::filesystem::path(folder) / fmt::format("reference-{:016x}.bin", print.value()))
      .string();
}

/// The file holds the key, a zero byte, and the numbers of both halves.
std::string packed(const std::string& key, const ReferenceHalves& halves) {
  std::string bytes = key + '\0';
  for (const auto* half : {&halves.first, &halves.second})
    bytes.append(reinterpret_cast<const char*>(half->data()), half->size() * sizeof(double));
  return bytes;
}

bool unpacked(const std::string& bytes, const std::string& key, std::size_t values,
              ReferenceHalves& halves) {
  const std::size_t half_bytes = values * sizeof(double);
  if (bytes.size() != key.size() + 1 + 2 * half_bytes) return false;
  if (bytes.compare(0, key.size(), key) != 0 || bytes[key.size()] != '\0') return false;
  halves.first.resize(values);
  halves.second.resize(values);
  std::memcpy(halves.first.data(), bytes.data() + key.size() + 1, half_bytes);
  std::memcpy(halves.second.data(), bytes.data() + key.size() + 1 + half_bytes, half_bytes);
  return true;
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ErrorKind::failed, fmt::format("cannot make {}: {}; --cache names another folder",
                                               folder, error.message()));
}

}  // namespace

std::string reference_key_text(const RivalScene& scene, const std::string& pass, int spp) {
  nlohmann::json key{{"format", kFormat},
                     {"scene", scene.spec},
                     {"opacity", scene.options.opacity},
                     {"content", content_of(scene.ours.scene())},
                     {"width", scene.view.width},
                     {"height", scene.view.height},
                     {"pass", pass},
                     {"spp", spp}};
  const Camera& camera = scene.view.camera;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      key["camera"].push_back(camera.to_world[row][column]);
  key["camera"].push_back(static_cast<int>(camera.kind));
  key["camera"].push_back(camera.fov_y);
  key["camera"].push_back(camera.half_height);
  return key.dump();
}

std::string default_cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return (std::filesystem::path(cache) / "dapple-bench").string();
  if (const char* home = std::getenv("HOME"); home && *home)
    return (std::filesystem::path(home) / ".cache" / "dapple-bench").string();
  return {};
}

ReferenceHalves cached_reference(const std::string& folder, const std::string& key,
                                 std::size_t values,
                                 const std::function<std::vector<double>(int)>& make) {
  ReferenceHalves halves;
  if (!folder.empty()) {
    make_folder(folder);
    std::ifstream file(file_of(folder, key), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (unpacked(bytes, key, values, halves)) return halves;
  }
  halves = {make(0), make(1)};
  if (!folder.empty()) write_whole_file(file_of(folder, key), packed(key, halves));
  return halves;
}

}  // namespace dapple::bench
