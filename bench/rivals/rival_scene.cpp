#include "rivals/rival_scene.hpp"

namespace dapple::bench {
namespace {

/// The view that PictureScene chooses: that of the loaded scene, before lights are added and meshes
/// merged.
View view_of(const std::string& spec, const RenderOptions& options) {
  std::vector<std::string> notes;
  return choose_view(load_scene(spec), options, notes);
}

}  // namespace

RivalScene::RivalScene(const std::string& scene_spec, const RenderOptions& render_options)
    : spec(scene_spec),
      options(render_options),
      ours(spec, options),
      view(view_of(spec, options)),
      geometry(ours.scene()),
      embree(geometry),
      camera(view),
      device(options.device, options.kernel_dir),
      on_device(upload(device, ours.scene(), ours.bvh())) {}

}  // namespace dapple::bench
