// Reads cameras: see camera.hpp.
#include "scene/gltf/camera.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <set>

#include "scene/free_names.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Imath::M44d;
using Imath::V3d;

/// Returns the matrix without scale, shear and mirroring. It keeps the view direction (-Z) and, as
/// far as possible, the up direction. Returns none when a scale is zero.
std::optional<M44f> rigid(const M44d& m) {
  const V3d back = V3d(m[2][0], m[2][1], m[2][2]).normalized();
  const V3d up_given(m[1][0], m[1][1], m[1][2]);
  const V3d up = (up_given - back * up_given.dot(back)).normalized();
  if (back.length() < 0.5 || up.length() < 0.5) return {};
  const V3d right = up.cross(back);
  return M44f(M44d(right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0,
                   m[3][0], m[3][1], m[3][2], 1));
}

void check_clip_planes(double near, double far, const std::string& who, const std::string& file) {
  const bool unlimited = far == 0;  // tinygltf's value for an absent zfar
  if (unlimited || far > near) return;
  fail(file, "{} has zfar {:g} and znear {:g}; zfar must be larger", who, far, near);
}

/// A length in metres that extras may have. The limits are those of the command line's options.
struct LensLength {
  const char* key;
  double low, high;
  float Camera::*member;
};

constexpr LensLength kLensLengths[] = {
    {"dapple_aperture", 0, 1e6, &Camera::lens_radius},
    {"dapple_focus_distance", 1e-6, 1e12, &Camera::focus_distance},
};

/// Reads the lens from the extras of a camera or of the node that places it. Keys that look as if
/// they were meant for dapple get a note.
void read_extras(const nlohmann::json& extras, const std::string& who, const std::string& file,
                 Camera& camera, std::vector<std::string>& notes) {
  if (!extras.is_object()) return;
  for (const auto& [name, value] : extras.items()) {
    const std::string& key = name;
    if (!key.starts_with("dapple_")) continue;
    const auto* const known = std::find_if(std::begin(kLensLengths), std::end(kLensLengths),
                                           [&](const LensLength& l) { return key == l.key; });
    if (known == std::end(kLensLengths)) {
      notes.push_back(
          one_line(fmt::format("{}: {} has extras.{}, which is ignored: dapple knows {} and {}",
                               file, who, excerpt(key), kLensLengths[0].key, kLensLengths[1].key)));
      continue;
    }
    const double length = value.is_number() ? value.get<double>() : -1;
    if (!(length >= known->low && length <= known->high))
      fail(file, "{} has extras.{} that is not a length in metres from {:g} to {:g}", who, key,
           known->low, known->high);
    camera.*known->member = static_cast<float>(length);
  }
}

Camera perspective(const tinygltf::PerspectiveCamera& given, const std::string& who,
                   const std::string& file) {
  Camera camera;
  camera.kind = Camera::Kind::perspective;
  camera.fov_y = static_cast<float>(given.yfov);
  if (!(camera.fov_y > 0 && given.yfov < std::numbers::pi)) {
    fail(file, "{} has yfov {}; it must be between 0 and pi", who, given.yfov);
  }
  check_clip_planes(given.znear, given.zfar, who, file);
  return camera;
}

Camera orthographic(const tinygltf::OrthographicCamera& given, const std::string& who,
                    const std::string& file) {
  Camera camera;
  camera.kind = Camera::Kind::orthographic;
  camera.half_height = static_cast<float>(std::abs(given.ymag));
  if (!(camera.half_height > 0)) fail(file, "{} has ymag 0", who);
  if (given.xmag == 0) fail(file, "{} has xmag 0", who);
  check_clip_planes(given.znear, given.zfar, who, file);
  return camera;
}

/// Reads all cameras of the document, also those without a placed node, so that any damage in the
/// file is found.
std::vector<Camera> read_lenses(const Document& document, std::vector<std::string>& notes) {
  std::vector<Camera> lenses;
  for (std::size_t i = 0; i < document.model.cameras.size(); ++i) {
    const auto& given = document.model.cameras[i];
    const std::string who = element("camera", i, given.name);
    lenses.push_back(given.type == "perspective"
                         ? perspective(given.perspective, who, document.file)
                         : orthographic(given.orthographic, who, document.file));
    read_extras(document.camera_extras[i], who, document.file, lenses.back(), notes);
  }
  return lenses;
}

std::string name_in_file(const Document& document, const tinygltf::Node& node) {
  const auto& camera = document.model.cameras[static_cast<std::size_t>(node.camera)];
  return one_line(!camera.name.empty() ? camera.name
                  : !node.name.empty() ? node.name
                                       : fmt::format("camera_{}", node.camera));
}

/// Names by which --camera reaches all of the nodes' cameras. The first one of a name keeps it.
std::vector<std::string> names_of(const Document& document, const std::vector<PlacedNode>& placed) {
  std::vector<std::string> given, names;
  FreeNames free;
  for (const PlacedNode& at : placed) {
    given.push_back(
        name_in_file(document, document.model.nodes[static_cast<std::size_t>(at.node)]));
    free.reserve(given.back());
  }
  std::set<std::string> kept;
  for (const std::string& name : given)
    names.push_back(kept.insert(name).second ? name : free.take(name));
  return names;
}

void add_camera(const Document& document, const PlacedNode& placed,
                const std::vector<Camera>& lenses, const std::string& name, Scene& scene) {
  const auto& node = document.model.nodes[static_cast<std::size_t>(placed.node)];
  const auto& given = document.model.cameras[static_cast<std::size_t>(node.camera)];
  const std::string who = element("camera", static_cast<std::size_t>(node.camera), given.name);
  Camera camera = lenses[static_cast<std::size_t>(node.camera)];
  const auto of_node = document.camera_node_extras.find(placed.node);
  if (of_node != document.camera_node_extras.end())
    read_extras(of_node->second, element("node", static_cast<std::size_t>(placed.node), node.name),
                document.file, camera, scene.warnings);
  camera.name = name;
  const std::optional<M44f> to_world = rigid(placed.to_world);
  if (!to_world) {
    scene.warnings.push_back(one_line(
        fmt::format("{}: {} is ignored: its node is scaled to nothing", document.file, who)));
    return;
  }
  camera.to_world = *to_world;
  scene.cameras.push_back(std::move(camera));
}

}  // namespace

void add_cameras(const Document& document, const std::vector<PlacedNode>& placed, Scene& scene) {
  const std::vector<Camera> lenses = read_lenses(document, scene.warnings);
  std::vector<PlacedNode> with_camera;
  for (const PlacedNode& at : placed)
    if (document.model.nodes[static_cast<std::size_t>(at.node)].camera >= 0)
      with_camera.push_back(at);
  const std::vector<std::string> names = names_of(document, with_camera);
  for (std::size_t i = 0; i < with_camera.size(); ++i)
    add_camera(document, with_camera[i], lenses, names[i], scene);
}

}  // namespace dapple::gltf
