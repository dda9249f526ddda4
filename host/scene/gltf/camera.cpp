// Reading cameras: see camera.hpp.
#include "scene/gltf/camera.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "scene/gltf/message.hpp"

namespace dapple::gltf {
namespace {

using Imath::M44d;
using Imath::V3d;

/// The matrix without scale, shear and mirroring, keeping where the camera looks (-Z) and
/// then which way is up; nothing where a scale of zero has lost them.
std::optional<M44f> rigid(const M44d& m) {
  const V3d back = V3d(m[2][0], m[2][1], m[2][2]).normalized();
  const V3d up_given(m[1][0], m[1][1], m[1][2]);
  const V3d up = (up_given - back * up_given.dot(back)).normalized();
  if (back.length() < 0.5 || up.length() < 0.5) return {};
  const V3d right = up.cross(back);
  return M44f(M44d(right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0,
                   m[3][0], m[3][1], m[3][2], 1));
}

void read_lens(const tinygltf::Camera& given, Camera& camera, const std::string& who,
               const std::string& file) {
  if (given.type == "perspective") {
    camera.kind = Camera::Kind::perspective;
    camera.fov_y = static_cast<float>(given.perspective.yfov);
    if (given.perspective.yfov > 0 && given.perspective.yfov < std::numbers::pi) return;
    fail(file, "{} has yfov {}; it must be between 0 and pi", who, given.perspective.yfov);
  }
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = static_cast<float>(std::abs(given.orthographic.ymag));
  if (!(camera.half_height > 0)) fail(file, "{} has ymag 0", who);
}

void add_camera(const Document& document, const PlacedNode& placed, Scene& scene) {
  const auto& node = document.model.nodes[static_cast<std::size_t>(placed.node)];
  const auto& given = document.model.cameras[static_cast<std::size_t>(node.camera)];
  const std::string who = element("camera", static_cast<std::size_t>(node.camera), given.name);
  Camera camera;
  camera.name = one_line(!given.name.empty()  ? given.name
                         : !node.name.empty() ? node.name
                                              : fmt::format("camera_{}", node.camera));
  read_lens(given, camera, who, document.file);
  const std::optional<M44f> to_world = rigid(placed.to_world);
  if (!to_world) {
    scene.warnings.push_back(one_line(
        fmt::format("{}: {} is left out: its node is scaled to nothing", document.file, who)));
    return;
  }
  camera.to_world = *to_world;
  scene.cameras.push_back(std::move(camera));
}

}  // namespace

void add_cameras(const Document& document, const std::vector<PlacedNode>& placed, Scene& scene) {
  for (const PlacedNode& at : placed) {
    if (document.model.nodes[static_cast<std::size_t>(at.node)].camera >= 0) {
      add_camera(document, at, scene);
    }
  }
}

}  // namespace dapple::gltf
