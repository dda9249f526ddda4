// dapple bake: a glTF file with AO, and bent normals, at its vertices or instances.
#include "dapple/bake.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/baked_attributes.hpp"
#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/output_paths.hpp"
#include "commands/progress.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "render/stopwatch.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

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

struct Seconds {
  double load = 0, write = 0, total = 0;
};

/// Root mean square of the standard errors of the values at vertices.
double standard_error(const BakeStatistics& s) {
  return s.vertices > 0 ? std::sqrt(s.squared_errors / static_cast<double>(s.vertices)) : 0.0;
}

void write_statistics(const BakeStatistics& s, const Seconds& seconds, const std::string& path) {
  const nlohmann::ordered_json json = {{"seconds",
                                        {{"load", seconds.load},
                                         {"build", s.seconds.build},
                                         {"upload", s.seconds.upload},
                                         {"trace", s.seconds.trace},
                                         {"write", seconds.write},
                                         {"total", seconds.total}}},
                                       {"triangles", s.triangles},
                                       {"vertices", s.vertices},
                                       {"points", s.points},
                                       {"rays", s.rays},
                                       {"standard_error", standard_error(s)},
                                       {"hidden_vertices", s.hidden_vertices},
                                       {"device", s.device},
                                       {"notes", s.notes}};
  write_whole_file(path, json.dump(2) + "\n");
}

void print_summary(const BakeStatistics& s, const Seconds& seconds, const std::string& output) {
  for (const std::string& note : s.notes) fmt::print(stderr, "note: {}\n", note);
  fmt::print(
      "{} triangles, {} vertices, {} rays from {} points ({:.1f} million rays a second)\n"
      "load {:.2f}, build {:.2f}, trace {:.2f}, write {:.2f}, total {:.2f} s\n",
      s.triangles, s.vertices, s.rays, s.points,
      s.seconds.trace > 0 ? static_cast<double>(s.rays) / s.seconds.trace * 1e-6 : 0.0,
      seconds.load, s.seconds.build, s.seconds.trace, seconds.write, seconds.total);
  if (s.vertices > 0)
    fmt::print("standard error of a vertex's AO {:.3f} (root mean square)\n", standard_error(s));
  if (s.hidden_vertices > 0)
    fmt::print("{} vertices lie inside closed geometry and have their neighbours' values\n",
               s.hidden_vertices);
  fmt::print("wrote {}\n", output);
}

void run_bake(const BakeArguments& a) {
  const BakeOptions options = to_options(a);
  std::vector<OutputPath> outputs{{"--output", a.output}};
  if (!a.stats_json.empty()) outputs.push_back({"--stats-json", a.stats_json});
  check_outputs(outputs);
  const std::string extension = fs::path(a.output).extension().string();
  if (extension != ".glb" && extension != ".gltf")
    throw Error(ErrorKind::usage,
                fmt::format("--output is {}; it must end in .glb or .gltf", a.output));
  if (a.scene.ends_with(".hair"))
    throw Error(ErrorKind::usage, a.scene + ": strands cannot be baked; only glTF files can");
  catch_interruptions();
  const Stopwatch total;
  Seconds seconds;
  ProgressBar progress(a.quiet);
  std::optional<SceneFile> input(std::in_place, a.scene, a.output);
  const Scene scene = load_gltf(input->path(), a.scene_options);
  check_outputs_spare(outputs, scene.files);
  std::vector<Scene> occluders;
  for (const std::string& path : a.occluders)
    occluders.push_back(load_scene(path, a.scene_options));
  const gltf::SourceFile file(input->path(), a.scene_options.allow_outside);
  input.reset();  // all of it is in memory
  std::vector<OutputPath> sides;
  for (const std::string& path : gltf::side_files_of(file, a.output))
    sides.push_back({"--output", path});
  check_outputs_spare(sides, scene.files);
  seconds.load = total.seconds();

  RenderControl control;
  control.progress = progress.callback();
  BakeResult result = bake(scene, options, control, occluders);
  progress.clear();

  const Stopwatch writing;
  std::vector<gltf::NewAttribute> attributes;
  std::vector<gltf::NodeValues> nodes;
  if (options.vertices)
    attributes = baked_attributes(file, scene, result.meshes, parse_channel(a.channel),
                                  a.blend == "multiply");
  if (options.instances) nodes = baked_nodes(scene, result.instance_ao);
  gltf::write_with_values(file, a.output, attributes, nodes);
  seconds.write = writing.seconds();
  seconds.total = total.seconds();
  for (const std::string& warning : scene.warnings) result.statistics.notes.push_back(warning);
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
