// dapple scene: a procedural scene as a GLB file, for other programs to read.
#include "dapple/scene.hpp"

#include <fmt/format.h>

#include <memory>

#include "commands/arguments/output_paths.hpp"
#include "commands/command.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"
#include "scene/procedural/procedural.hpp"

namespace dapple {
namespace {

struct SceneArguments {
  std::string name, output;
  std::vector<std::string> parameters;
  bool quiet = false;
};

/// "tree" and {"leaves=5", "seed=2"} to "scene:tree?leaves=5&seed=2".
std::string scene_name(const SceneArguments& a) {
  std::string name = a.name.starts_with("scene:") ? a.name : "scene:" + a.name;
  char joint = name.find('?') == std::string::npos ? '?' : '&';
  for (const std::string& parameter : a.parameters) {
    name += joint + parameter;
    joint = '&';
  }
  return name;
}

std::string catalogue() {
  std::string text =
      "Example:\n  dapple scene tree leaves=20000 seed=3 -o tree.glb\n\nScenes and their "
      "parameters:\n";
  for (const ProceduralHelp& scene : procedural_help()) {
    text += fmt::format("  {}: {}\n", scene.name, scene.help);
    for (const ProceduralParameter& p : scene.parameters) {
      text += fmt::format("      {:<10} {} (default {:.10g}, {:.10g} to {:.10g})\n", p.name, p.help,
                          p.default_value, p.minimum, p.maximum);
    }
  }
  return text;
}

}  // namespace

Run add_scene_command(CLI::App& app) {
  auto a = std::make_shared<SceneArguments>();
  app.add_option("NAME", a->name, "One of the scenes below")->required();
  app.add_option("PARAMETER", a->parameters, "KEY=VALUE, any number of them");
  app.add_option("-o,--output", a->output, "GLB file to write")->required();
  app.add_flag("-q,--quiet", a->quiet, "Print only errors");
  app.footer(catalogue());
  return [a] {
    check_outputs({{"--output", a->output}});
    if (!a->output.ends_with(".glb"))
      throw Error(ErrorKind::usage, fmt::format("--output is {}; it must end in .glb", a->output));
    const Scene scene = make_procedural(scene_name(*a));
    write_glb(scene, a->output);
    if (a->quiet) return;
    std::size_t triangles = 0, segments = 0;
    for (const Mesh& mesh : scene.meshes)
      (mesh.has_strands() ? segments : triangles) += mesh.primitive_count();
    put("wrote {}: {} triangles, {}{} instances\n", a->output, triangles,
        segments > 0 ? fmt::format("{} segments, ", segments) : "", scene.instances.size());
  };
}

}  // namespace dapple
