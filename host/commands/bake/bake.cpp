// dapple bake: a glTF file with AO, bent normals and light at its vertices, in a texture or at its
// instances.
#include "dapple/bake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "bake/preview.hpp"
#include "commands/arguments/option_text.hpp"
#include "commands/arguments/output_name.hpp"
#include "commands/arguments/output_paths.hpp"
#include "commands/arguments/shared_options.hpp"
#include "commands/bake/bake_report.hpp"
#include "commands/bake/baked_attributes.hpp"
#include "commands/bake/baked_nodes.hpp"
#include "commands/bake/baked_texture.hpp"
#include "commands/bake/scene_file.hpp"
#include "commands/bake/side_copies.hpp"
#include "commands/bake/unique_meshes.hpp"
#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/progress.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "render/stopwatch.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace dapple {
namespace {

namespace fs = std::filesystem;

/// Width and height of previews.
constexpr int kPreviewSize = 1024;

/// NAME_baked.exr beside the output.
std::string exr_path(const std::string& output) {
  const fs::path path(output);
  return (path.parent_path() / (path.stem().string() + "_baked.exr")).string();
}

/// Whether there is more to write than a PNG holds.
bool needs_exr(const BakeOptions& options) {
  return options.texture && (options.bent || options.light);
}

/// The paths that the options name. Throws Error usage for two that are the same file, or that
/// cannot be written.
std::vector<OutputPath> named_outputs(const BakeArguments& a, const BakeOptions& options) {
  std::vector<OutputPath> outputs{{"--output", a.output}};
  if (!a.stats_json.empty()) outputs.push_back({"--stats-json", a.stats_json});
  check_png_name(a.png);
  if (!a.png.empty()) outputs.push_back({"--png", a.png});
  if (needs_exr(options)) outputs.push_back({"--passes", exr_path(a.output)});
  // A new checkpoint may replace the one that the bake resumes from.
  if (!a.resume.empty()) check_outputs_spare(outputs, {a.resume});
  if (!a.checkpoint.empty()) outputs.push_back({"--checkpoint", a.checkpoint});
  check_outputs(outputs);
  const std::string extension = fs::path(a.output).extension().string();
  if (extension != ".glb" && extension != ".gltf")
    throw Error(ErrorKind::usage,
                fmt::format("--output is {}; it must end in .glb or .gltf", a.output));
  return outputs;
}

/// Files beside a .gltf that the command writes. Throws Error usage for copies of the scene's files
/// that cannot be made.
std::vector<OutputPath> side_outputs(const gltf::SourceFile& file, const BakeArguments& a,
                                     const BakeOptions& options) {
  std::vector<OutputPath> sides;
  const gltf::Editor editor(file, a.output);
  check_side_copies(a.output, editor.side_copies());
  std::vector<std::string> new_files = editor.new_side_files();
  if (options.texture && a.output.ends_with(".gltf"))
    new_files.push_back(editor.image_path(gltf::kOcclusionSuffix));
  std::vector<std::string> unknown = new_files;
  if (needs_exr(options)) unknown.push_back(exr_path(a.output));
  check_new_sides(a.output, unknown);
  for (const std::string& path : new_files) sides.push_back({"--output", path});
  for (const auto& [from, to] : editor.side_copies()) sides.push_back({"--output", to});
  return sides;
}

/// Throws Error usage for a file beside the .gltf that is an input or one of `named`, or cannot be
/// written. Folders that are made for copies hold no file yet.
void check_sides(const std::vector<OutputPath>& sides, const std::vector<OutputPath>& named,
                 const std::vector<std::string>& inputs) {
  check_outputs_spare(sides, inputs);
  for (const OutputPath& side : sides) {
    std::error_code ignored;
    const fs::path folder = fs::path(side.path).parent_path();
    if (!folder.empty() && !fs::exists(folder, ignored)) continue;
    check_outputs({side}, Folders::leave);
    for (const OutputPath& other : named) check_outputs({other, side}, Folders::leave);
  }
}

/// What viewers make of AO in one component of colours; empty for other channels.
std::string component_note(const BakeChannel& channel) {
  if (channel.components == "a")
    return "COLOR_0.a is opacity in glTF: where AO is low, viewers show masked and blended "
           "materials more transparent";
  for (const auto& [component, color] : {std::pair{"r", "red"}, {"g", "green"}, {"b", "blue"}})
    if (channel.components == component)
      return fmt::format(
          "COLOR_0.{} is {} in glTF: where AO is low, viewers show less {}, "
          "which tints the model",
          component, color, color);
  return {};
}

/// Names lights that an earlier bake wrote and this one does not; empty: there are none.
std::string earlier_lights_note(const gltf::SourceFile& file, const Scene& scene,
                                const BakeResult& result) {
  std::set<std::string> left;
  for (const Mesh& mesh : scene.meshes)
    for (const VertexSource& source : mesh.sources)
      for (const std::string& name : file.attributes(source.mesh, source.primitive))
        if (name.starts_with("_LIGHT_")) left.insert(name);
  for (const std::string& light : result.light_names) left.erase("_LIGHT_" + light);
  if (left.empty() || result.light_names.empty()) return {};
  return fmt::format("the file keeps {} of an earlier bake", fmt::join(left, ", "));
}

/// Adds values at vertices. Returns notes.
std::vector<std::string> add_to_vertices(gltf::Editor& editor, const gltf::SourceFile& file,
                                         const Scene& scene, const BakeArguments& a,
                                         const BakeResult& result) {
  const BakeTargets targets{channel_of(a), a.blend == "multiply", a.bent_channel,
                            a.options.placement};
  gltf::add_attributes(editor, baked_attributes(file, scene, result, targets));
  std::vector<std::string> notes;
  if (multiplies_colors(file, scene, result, targets))
    notes.emplace_back(
        "COLOR_0 of the file is multiplied by AO; if it holds baked AO already, use --blend "
        "replace");
  notes.push_back(component_note(targets.channel));
  notes.push_back(earlier_lights_note(file, scene, result));
  return notes;
}

/// Adds values of instances. Returns notes.
std::vector<std::string> add_to_instances(gltf::Editor& editor, const gltf::SourceFile& file,
                                          const Scene& scene, const BakeArguments& a,
                                          const BakeResult& result) {
  const std::string attribute = channel_of(a).attribute;
  const std::vector<gltf::NodeValues> nodes = baked_nodes(file, scene, result, attribute);
  std::vector<std::string> notes = gltf::add_node_values(editor, nodes);
  const auto has_attribute = [&](const gltf::NodeValues& values) {
    return file.has_gpu_instances(values.node);
  };
  if (a.channel && std::none_of(nodes.begin(), nodes.end(), has_attribute))
    notes.push_back(
        fmt::format("no node has EXT_mesh_gpu_instancing: there is no {}, all values are extras.ao",
                    attribute));
  return notes;
}

void write_preview(const Scene& scene, const BakeResult& result, const std::string& path) {
  const Camera camera = scene.cameras.empty() ? frame_scene(scene, 1.0f) : scene.cameras.front();
  write_whole_file(
      path, encode_png(draw_preview(scene, result, camera, kPreviewSize, kPreviewSize), path));
}

/// Of chunks that only a GLB has; empty: there are none.
std::string lost_note(std::size_t bytes) {
  if (bytes == 0) return {};
  return fmt::format(
      "{} bytes of GLB chunks that are neither JSON nor BIN are left out: a .gltf has none; "
      "-o FILE.glb keeps them",
      bytes);
}

/// Writes the file with the baked values and the EXR of a texture. Neither gets its name before
/// both are written. Returns notes, some of them empty.
std::vector<std::string> write_baked(const gltf::SourceFile& file, const Scene& scene,
                                     const BakeArguments& a, const BakeOptions& options,
                                     const FileUvs& uvs, const BakeResult& result) {
  gltf::Editor editor(file, a.output);
  std::vector<std::string> notes;
  if (options.vertices) notes = add_to_vertices(editor, file, scene, a, result);
  if (options.instances) notes = add_to_instances(editor, file, scene, a, result);
  if (options.texture) {
    const TextureLayout& layout = result.texture.layout;
    const auto primitives = textured_primitives(file, scene, layout, uvs.set);
    const std::size_t replaced =
        gltf::add_occlusion_texture(editor, primitives, occlusion_png(result.texture, a.bits));
    const auto unlit = std::count_if(
        primitives.begin(), primitives.end(),
        [&](const gltf::TexturedPrimitive& p) { return file.is_unlit(p.mesh, p.primitive); });
    notes = {coordinates_note(layout, primitives, uvs.note), texture_note(result.texture),
             replaced_note(replaced), unlit_note(static_cast<std::size_t>(unlit))};
  }
  PendingFiles files;
  editor.write(files);
  if (needs_exr(options))
    write_baked_exr(result, scene.source, options, files.add(exr_path(a.output)));
  files.commit();
  notes.push_back(lost_note(editor.lost_bytes()));
  return notes;
}

/// Chooses the lights to bake: those of --lights or else the scene's, and --dome beside them.
/// Throws Error usage if there are none at all.
void choose_lights(const BakeArguments& a, Scene& scene) {
  if (!a.lights.empty()) use_lights(scene, load_lights(a.lights));
  if (!a.dome.empty()) {
    scene.lights.push_back(dome_light("dome", a.dome));
    scene.lights.back().rotation = dome_rotation("--dome-rotation", a.dome_rotation);
  }
  if (scene.lights.empty())
    throw Error(ErrorKind::usage,
                fmt::format("--passes light: {} has no lights; --lights or --dome brings some",
                            a.lights.empty() ? "the scene" : a.lights));
}

std::vector<Scene> load_occluders(const BakeArguments& a) {
  std::vector<Scene> occluders;
  for (const std::string& path : a.occluders)
    occluders.push_back(load_scene(path, a.scene_options));
  return occluders;
}

/// All input files, which no output may replace.
std::vector<std::string> files_read(const BakeArguments& a, const Scene& scene,
                                    const std::vector<Scene>& occluders) {
  std::vector<std::string> files = scene.files;
  for (const Scene& occluder : occluders)
    files.insert(files.end(), occluder.files.begin(), occluder.files.end());
  for (const std::string& path : {a.lights, a.dome})
    if (!path.empty()) files.push_back(path);
  return files;
}

RenderControl to_control(const BakeArguments& a, ProgressBar& progress) {
  RenderControl control;
  control.progress = progress.callback();
  // Without a checkpoint there is nothing to save: a signal ends the process at once.
  if (!a.checkpoint.empty()) {
    control.stop = save_when_interrupted();
    control.progress = end_early(a.checkpoint, a.resume, control.progress);
  }
  control.warn = warn_of_checkpoint;
  control.checkpoint = a.checkpoint;
  control.checkpoint_every = parse_seconds("--checkpoint-every", a.checkpoint_every);
  control.resume = a.resume;
  return control;
}

void report_interruption(BakeResult& result, const BakeSeconds& seconds, const BakeArguments& a) {
  const std::string note =
      fmt::format("interrupted, {} is not written; --resume {} goes on", a.output, a.checkpoint);
  result.statistics.notes.push_back(note);
  if (!a.stats_json.empty()) write_statistics(result, seconds, a.stats_json);
  if (!result.checkpoint_failure.empty())
    throw Error(ErrorKind::failed, result.checkpoint_failure + "; the bake was interrupted");
  tell("note: {}\n", note);
}

/// Throws Error usage for a channel that the file or a light needs for other values.
void check_values_fit(const gltf::SourceFile& file, const Scene& scene, const BakeChannel& channel,
                      const BakeOptions& options) {
  if (options.vertices) check_channel(file, scene, channel);
  if (options.light) check_channel_spares_lights(channel, scene.lights);
}

/// Keeps what is freed for what is allocated next. Every batch of samples has arrays of many
/// megabytes, and the kernel would clear each of their pages again.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMost = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, kMost);
  mallopt(M_TRIM_THRESHOLD, kMost);
#endif
}

void run_bake(const CLI::App& app, const BakeArguments& a) {
  keep_freed_memory();
  BakeOptions options = to_options(a);
  refuse_options_without_effect(app, options);
  const std::vector<OutputPath> outputs = named_outputs(a, options);
  if (a.scene.ends_with(".hair"))
    throw Error(ErrorKind::usage, a.scene + ": strands cannot be baked; only glTF files can");
  catch_interruptions();
  const Stopwatch total;
  BakeSeconds seconds;
  ProgressBar progress(a.quiet, "baking");
  const RenderControl control = to_control(a, progress);
  progress.announce("reading", a.scene);
  std::optional<SceneFile> input(std::in_place, a.scene, a.output);
  Scene scene = load_gltf(input->path(), a.scene_options);
  scene.source = a.scene;
  if (!input->lights().empty()) scene.lights = input->lights();
  const std::vector<Scene> occluders = load_occluders(a);
  check_outputs_spare(outputs, files_read(a, scene, occluders));
  if (options.light) {
    if (!a.dome.empty()) progress.announce("reading", a.dome);
    choose_lights(a, scene);
  }
  const std::vector<std::string> inputs = files_read(a, scene, occluders);  // and images of lights
  check_outputs_spare(outputs, inputs);
  gltf::SourceFile file(input->path(), a.scene_options.allow_outside);
  input.reset();  // all of it is in memory
  if (a.instances == "unique") make_meshes_unique(file, scene);
  check_sides(side_outputs(file, a, options), outputs, inputs);
  if (!options.texture) check_values_fit(file, scene, channel_of(a), options);
  FileUvs uvs;
  if (options.texture && a.uv != "own") uvs = choose_uvs(file, scene, options);
  options.texture_uvs = std::move(uvs.uvs);
  seconds.load = total.seconds();

  progress.announce("building", "the BVH");
  BakeResult result = bake(scene, options, control, occluders);
  slices_are_traced();
  progress.clear();
  seconds.total = total.seconds();
  if (result.interrupted) return report_interruption(result, seconds, a);

  const Stopwatch writing;
  const std::vector<std::string> notes = write_baked(file, scene, a, options, uvs, result);
  if (!a.png.empty()) write_preview(scene, result, a.png);
  seconds.write = writing.seconds();
  seconds.total = total.seconds();
  for (const std::string& note : notes)
    if (!note.empty()) result.statistics.notes.push_back(note);
  if (!a.stats_json.empty()) write_statistics(result, seconds, a.stats_json);
  if (!a.quiet) print_summary(result.statistics, seconds, a.output);
  if (!result.checkpoint_failure.empty())
    throw Error(ErrorKind::failed, result.checkpoint_failure + "; the baked file is written");
}

}  // namespace

Run add_bake_command(CLI::App& app) {
  auto a = std::make_shared<BakeArguments>();
  add_bake_options(app, *a);
  return [a, &app] { run_bake(app, *a); };
}

}  // namespace dapple
