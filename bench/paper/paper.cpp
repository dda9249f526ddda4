#include "paper/paper.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "accuracy/report.hpp"
#include "files/output_file.hpp"
#include "paper/variants.hpp"

namespace dapple::bench {
namespace {

struct Arguments {
  std::vector<std::string> scenes{"scene:tree?leaves=1000000&opacity=0.85",
                                  "scene:cloud?leaves=1000000&opacity=0.85"};
  std::vector<std::string> opacity;
  std::string json;
  int size = 128, repeats = 5;
  RenderOptions render;
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("SCENE", a.scenes, "Scenes; default: a tree and a cloud of 2 million triangles");
  app.add_option("--opacity", a.opacity, "MATERIAL=VALUE: that opacity for a material; repeatable");
  app.add_option("--size", a.size, "Width and height of the images")->capture_default_str();
  app.add_option("--repeats", a.repeats, "Images per variant")
      ->capture_default_str()
      ->check(CLI::Range(2, 1000));
  app.add_option("--device", a.render.device, "Part of an OpenCL device's name");
  app.add_option("--json", a.json, "Write the figures as JSON");
  app.footer(
      "Lacewell et al. 2008: 5x5 primary samples per pixel, opacity 0.85; seconds of the occlusion "
      "rays alone.\nExample:\n  dapple-bench paper --size 256 --json paper.json");
}

std::string rows_text(const std::vector<PaperRow>& rows) {
  std::vector<std::vector<std::string>> cells{{"estimator", "rays per sample", "AO s", "AO noise",
                                               "AO RMSE", "light s", "light noise", "light RMSE"}};
  for (const PaperRow& row : rows) {
    cells.push_back({row.variant.name, fmt::format("{}", row.variant.rays)});
    for (const PaperFigures& figures : {row.ao, row.light}) {
      cells.back().push_back(fmt::format("{:.2f}", figures.seconds));
      cells.back().push_back(fmt::format("{:.4f}", figures.noise));
      cells.back().push_back(fmt::format("{:.4f}", figures.rmse));
    }
  }
  return table_text(cells);
}

nlohmann::json rows_json(const std::vector<PaperRow>& rows) {
  const auto of = [](const PaperFigures& figures) {
    return nlohmann::json{
        {"occlusion_seconds", figures.seconds}, {"noise", figures.noise}, {"rmse", figures.rmse}};
  };
  nlohmann::json out = nlohmann::json::array();
  for (const PaperRow& row : rows) {
    out.push_back({{"estimator", row.variant.name},
                   {"rays", row.variant.rays},
                   {"footprint", row.variant.footprint},
                   {"ao", of(row.ao)},
                   {"light", of(row.light)}});
  }
  return out;
}

}  // namespace

int run_paper(int argc, char** argv) {
  Arguments a;
  CLI::App app("The experiment of Lacewell et al. 2008, again", "dapple-bench paper");
  add_options(app, a);
  CLI11_PARSE(app, argc, argv);
  a.render.width = a.render.height = a.size;
  a.render.spp = 25;
  for (const std::string& text : a.opacity)
    a.render.opacity.push_back(parse_material_opacity(text));
  validate(a.render);
  if (!a.json.empty()) check_output_path(a.json);
  nlohmann::json figures = nlohmann::json::array();
  for (const std::string& spec : a.scenes) {
    PictureScene scene(spec, a.render);
    const auto rows = measure_paper(scene, a.render, a.repeats);
    fmt::print("{}, {} triangles, {}x{}, 25 primary samples per pixel\n{}\n", spec,
               scene.bvh().statistics.triangles, a.size, a.size, rows_text(rows));
    std::fflush(stdout);
    figures.push_back(
        {{"scene", spec}, {"device", scene.device_name()}, {"variants", rows_json(rows)}});
  }
  write_report(a.json, figures.dump(2) + "\n");
  return 0;
}

}  // namespace dapple::bench
