// dapple bake: a glTF file with AO, and bent normals, at its vertices or instances.
#include "dapple/bake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>

#include "bake/preview.hpp"
#include "commands/bake_report.hpp"
#include "commands/baked_attributes.hpp"
#include "commands/baked_texture.hpp"
#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/output_paths.hpp"
#include "commands/progress.hpp"
#include "commands/unique_meshes.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "render/stopwatch.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

/// Width and height of previews.
constexpr int kPreviewSize = 1024;

/// The file to bake. A procedural scene is written as a GLB file beside the output, and removed
/// once it is read.
class SceneFile {
 public:
  SceneFile(const std::string& spec, const std::string& output) : path_(spec) {
    if (!spec.starts_with("scene:")) return;
    path_ = output + ".scene.glb";
    is_made_ = true;
    write_glb(make_procedural(spec), path_);
  }
  ~SceneFile() {
    std::error_code ignored;
    if (is_made_) fs::remove(path_, ignored);
  }
  SceneFile(const SceneFile&) = delete;
  SceneFile& operator=(const SceneFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  bool is_made_ = false;
};

/// A file beside the output: NAME`suffix``extension`.
std::string beside(const std::string& output, const std::string& suffix,
                   const std::string& extension) {
  const fs::path path(output);
  return (path.parent_path() / (path.stem().string() + suffix + extension)).string();
}

std::string bent_path(const std::string& output) { return beside(output, "_bent", ".exr"); }

/// The paths that the options name. Throws Error usage for two that are the same file, or that
/// cannot be written.
std::vector<OutputPath> named_outputs(const BakeArguments& a, const BakeOptions& options) {
  std::vector<OutputPath> outputs{{"--output", a.output}};
  if (!a.stats_json.empty()) outputs.push_back({"--stats-json", a.stats_json});
  if (!a.png.empty()) outputs.push_back({"--png", a.png});
  if (options.texture && options.bent) outputs.push_back({"--passes bent", bent_path(a.output)});
  check_outputs(outputs);
  const std::string extension = fs::path(a.output).extension().string();
  if (extension != ".glb" && extension != ".gltf")
    throw Error(ErrorKind::usage,
                fmt::format("--output is {}; it must end in .glb or .gltf", a.output));
  return outputs;
}

/// Files beside a .gltf that the command writes.
std::vector<OutputPath> side_outputs(const gltf::SourceFile& file, const BakeArguments& a,
                                     const BakeOptions& options) {
  std::vector<OutputPath> sides;
  for (const std::string& path : gltf::Editor(file, a.output).side_files_written())
    sides.push_back({"--output", path});
  if (options.texture && a.output.ends_with(".gltf"))
    sides.push_back({"--output", beside(a.output, gltf::kOcclusionSuffix, ".png")});
  return sides;
}

/// Writes the file with the baked values, and the bent normals of a texture.
void write_baked(const gltf::SourceFile& file, const Scene& scene, const BakeArguments& a,
                 const BakeOptions& options, std::uint32_t uv_set, const BakeResult& result) {
  gltf::Editor editor(file, a.output);
  if (options.vertices)
    gltf::add_attributes(
        editor, file,
        baked_attributes(file, scene, result,
                         {parse_channel(a.channel), a.blend == "multiply", a.bent_channel}));
  if (options.instances) gltf::add_node_values(editor, baked_nodes(scene, result.instance_ao));
  if (options.texture)
    gltf::add_occlusion_texture(editor,
                                textured_primitives(file, scene, result.texture.layout, uv_set),
                                occlusion_png(result.texture));
  editor.write();
  if (options.texture && options.bent) write_bent_exr(result.texture, bent_path(a.output));
}

void write_preview(const Scene& scene, const BakeResult& result, const std::string& path) {
  const Camera camera = scene.cameras.empty() ? frame_scene(scene, 1.0f) : scene.cameras.front();
  write_whole_file(
      path, encode_png(draw_preview(scene, result, camera, kPreviewSize, kPreviewSize), path));
}

/// The lights to bake; none: the scene's own. With --dome its mesh lights are ignored. Throws Error
/// usage if there are none at all.
std::vector<Light> baked_lights(const BakeArguments& a, const Scene& scene) {
  std::vector<Light> lights;
  if (!a.lights.empty()) lights = load_lights(a.lights);
  if (a.dome.empty() && lights.empty() && scene.lights.empty())
    throw Error(ErrorKind::usage,
                "--passes light: the scene has no lights; --lights or --dome brings some");
  if (a.dome.empty()) return lights;
  if (a.lights.empty())
    std::copy_if(scene.lights.begin(), scene.lights.end(), std::back_inserter(lights),
                 [](const Light& light) { return light.kind != LightKind::mesh; });
  lights.emplace_back();
  lights.back().name = "dome";
  lights.back().kind = LightKind::dome;
  lights.back().environment = load_environment(a.dome);
  return lights;
}

/// Chooses the texture coordinates. Returns a line about them.
std::string choose_layout(const gltf::SourceFile& file, const Scene& scene, const std::string& uv,
                          BakeOptions& options, std::uint32_t& set) {
  if (uv == "own") return {};
  FileUvs chosen = choose_uvs(file, scene, options.texture_size);
  set = chosen.set;
  options.texture_uvs = std::move(chosen.uvs);
  if (!options.texture_uvs.empty()) return fmt::format("the texture uses TEXCOORD_{}", set);
  return chosen.note.empty() ? "" : chosen.note + ": the texture has coordinates of its own";
}

void run_bake(const BakeArguments& a) {
  BakeOptions options = to_options(a);
  const std::vector<OutputPath> outputs = named_outputs(a, options);
  if (a.scene.ends_with(".hair"))
    throw Error(ErrorKind::usage, a.scene + ": strands cannot be baked; only glTF files can");
  catch_interruptions();
  const Stopwatch total;
  BakeSeconds seconds;
  ProgressBar progress(a.quiet, "baking");
  std::optional<SceneFile> input(std::in_place, a.scene, a.output);
  Scene scene = load_gltf(input->path(), a.scene_options);
  check_outputs_spare(outputs, scene.files);
  std::vector<Scene> occluders;
  for (const std::string& path : a.occluders)
    occluders.push_back(load_scene(path, a.scene_options));
  gltf::SourceFile file(input->path(), a.scene_options.allow_outside);
  input.reset();  // all of it is in memory
  if (a.instances == "unique") make_meshes_unique(file, scene);
  check_outputs_spare(side_outputs(file, a, options), scene.files);
  if (options.light) options.lights = baked_lights(a, scene);
  if (options.vertices) check_channel(file, scene, parse_channel(a.channel));
  std::uint32_t uv_set = 0;
  std::string layout_note;
  if (options.texture) layout_note = choose_layout(file, scene, a.uv, options, uv_set);
  seconds.load = total.seconds();

  RenderControl control;
  control.progress = progress.callback();
  BakeResult result = bake(scene, options, control, occluders);
  progress.clear();

  const Stopwatch writing;
  write_baked(file, scene, a, options, uv_set, result);
  if (!a.png.empty()) write_preview(scene, result, a.png);
  seconds.write = writing.seconds();
  seconds.total = total.seconds();
  std::vector<std::string>& notes = result.statistics.notes;
  if (!layout_note.empty()) notes.push_back(layout_note);
  if (options.texture) notes.push_back(texture_note(result.texture));
  notes.insert(notes.end(), scene.warnings.begin(), scene.warnings.end());
  if (!a.stats_json.empty()) write_statistics(result.statistics, seconds, a.stats_json);
  if (!a.quiet) print_summary(result.statistics, seconds, a.output);
}

}  // namespace

Run add_bake_command(CLI::App& app) {
  auto a = std::make_shared<BakeArguments>();
  add_bake_options(app, *a);
  return [a] { run_bake(*a); };
}

}  // namespace dapple
