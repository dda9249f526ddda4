#include "accuracy/accuracy.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>

#include "accuracy/line_accuracy.hpp"
#include "accuracy/prefilter_cost.hpp"
#include "accuracy/report.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"

namespace dapple::bench {
namespace {

struct Arguments {
  std::string scene, json, svg;
  std::vector<std::string> opacity;
  bool nodes_only = false, images_only = false, line = false, linear = false, quick = false;
  int size = 256;
  NodeAccuracyOptions nodes;
  ImageAccuracyOptions images;
  LineAccuracyOptions lines;
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("SCENE", a.scene, "glTF file or a procedural scene, \"scene:tree?leaves=50000\"");
  app.add_option("--opacity", a.opacity, "MATERIAL=VALUE: that opacity for a material; repeatable");
  auto* nodes = app.add_flag("--nodes-only", a.nodes_only, "Only nodes; needs no OpenCL device");
  app.add_flag("--images-only", a.images_only, "Only images")->excludes(nodes);
  app.add_flag("--line", a.line, "Only whether AO pops along a line and as the camera moves away");
  app.add_flag("--linear", a.linear, "Only time and memory of prefiltering clouds; takes no SCENE");
  app.add_option("--seeds", a.images.seeds, "Images per footprint")
      ->capture_default_str()
      ->check(CLI::Range(2, 10000));
  app.add_option("--spp", a.images.render.spp, "Camera samples per pixel")->capture_default_str();
  app.add_option("--size", a.size, "Width and height of the images")->capture_default_str();
  app.add_option("--device", a.images.render.device, "Part of an OpenCL device's name");
  app.add_flag("--quick", a.quick, "A tenth of the work: fewer nodes, seeds and pixels");
  app.add_option("--json", a.json, "Write the figures as JSON");
  app.add_option("--svg", a.svg, "Plot the images' errors against the footprint");
  app.footer("Example:\n  dapple-bench accuracy tree.glb --opacity leaf=0.85 --svg tree.svg");
}

/// About a tenth of the work, with about three times the uncertainty.
void make_quick(Arguments& a) {
  a.nodes.nodes = 20;
  a.nodes.directions = 4;
  a.images.seeds = 4;
  a.size = 160;
  a.lines.points = 400;
  a.lines.frames = 20;
}

void apply_options(Arguments& a) {
  if (a.scene.empty() != a.linear)
    throw Error(ErrorKind::usage, a.linear ? "--linear takes no SCENE" : "SCENE is missing");
  if (a.quick) make_quick(a);
  RenderOptions& render = a.images.render;
  render.width = render.height = a.size;
  for (const std::string& text : a.opacity) render.opacity.push_back(parse_material_opacity(text));
  validate(render);
  if (!a.json.empty()) check_output_path(a.json);
  if (!a.svg.empty()) check_output_path(a.svg);
}

/// Runs a study that only prints a table. Returns false if none was requested.
bool ran_study(const Arguments& a) {
  if (a.linear) {
    fmt::print("{}", cost_text(measure_prefilter_cost(a.quick)));
  } else if (a.line) {
    LineAccuracyOptions lines = a.lines;
    lines.render = a.images.render;
    fmt::print("{}\n{}", a.scene, line_text(measure_line(a.scene, lines)));
  } else {
    return false;
  }
  return true;
}

/// Shows the fraction done on a line that is overwritten. Prints nothing without a terminal.
void show_progress(double share) {
  if (!isatty(STDERR_FILENO)) return;
  fmt::print(stderr, "\rpictures: {:.0f} %{}", 100 * share, share < 1 ? "" : "\r\033[K");
  std::fflush(stderr);
}

}  // namespace

int run_accuracy(int argc, char** argv) {
  Arguments a;
  CLI::App app("How far prefiltered occlusion is from exact, node by node and in pictures",
               "dapple-bench accuracy");
  add_options(app, a);
  CLI11_PARSE(app, argc, argv);
  apply_options(a);
  if (ran_study(a)) return 0;
  PictureScene scene(a.scene, a.images.render);
  nlohmann::json figures{{"scene", a.scene}, {"opacity", a.opacity}};
  fmt::print("{}, {} triangles\n", a.scene, scene.bvh().statistics.triangles);
  if (!a.images_only) {
    const auto rows = measure_nodes(scene.scene(), scene.bvh(), a.nodes);
    fmt::print("\n{}", nodes_text(rows));
    std::fflush(stdout);
    figures["nodes"] = nodes_json(rows);
  }
  if (!a.nodes_only) {
    const auto rows = measure_images(scene, a.images, show_progress);
    fmt::print("\n{}", images_text(rows));
    figures["images"] = images_json(rows);
    figures["device"] = scene.device_name();
    write_report(a.svg, images_svg(rows, a.scene));
  }
  write_report(a.json, figures.dump(2) + "\n");
  return 0;
}

}  // namespace dapple::bench
