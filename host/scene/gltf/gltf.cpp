// load_gltf: from a path to a Scene, step by step. Each step is a file of this folder;
// only this folder knows tinygltf.
#include <new>

#include "dapple/scene.hpp"
#include "scene/gltf/camera.hpp"
#include "scene/gltf/crowding.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/hierarchy.hpp"
#include "scene/gltf/instance.hpp"
#include "scene/gltf/light.hpp"
#include "scene/gltf/material.hpp"
#include "scene/gltf/message.hpp"

namespace dapple {
namespace {

Scene read_scene(const std::string& path, const SceneOptions& options) {
  const gltf::Document document = gltf::load_document(path, options.allow_outside);
  const std::vector<gltf::PlacedNode> placed = gltf::place_nodes(document);
  Scene scene;
  scene.source = path;
  scene.files = document.files;
  const gltf::MaterialSet materials = gltf::read_materials(document, placed, scene);
  gltf::add_instances(document, placed, materials, scene);
  if (scene.instances.empty()) gltf::fail(path, "has no triangles");
  gltf::check_crowding(scene);
  gltf::add_punctual_lights(document, placed, options, scene);
  gltf::add_cameras(document, placed, scene);
  return scene;
}

}  // namespace

Scene load_gltf(const std::string& path, const SceneOptions& options) {
  validate(options);
  try {
    return read_scene(path, options);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::failed, path + ": there is not enough memory to read it");
  }
}

}  // namespace dapple
