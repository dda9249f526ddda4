#include "rivals/rivals.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "accuracy/report.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "rivals/protocols/bake_protocol.hpp"
#include "rivals/protocols/image_protocol.hpp"
#include "rivals/protocols/point_protocol.hpp"
#include "rivals/protocols/ray_protocol.hpp"
#include "rivals/reference_cache.hpp"
#include "rivals/rival_report.hpp"

namespace dapple::bench {
namespace {

/// Number of points for the protocol "rays".
constexpr std::size_t kRayPoints = 1u << 14;
constexpr std::uint32_t kRaySeed = 1;

const std::vector<double> kPointTargets{0.05, 0.03, 0.02, 0.01};
const std::vector<double> kBakeTargets{0.05, 0.03, 0.02};
const std::vector<double> kImageTargets{0.05, 0.02, 0.01};

struct Arguments {
  std::vector<std::string> scenes, opacity;
  std::string protocol = "all", pass = "all", cache = default_cache_folder(), json, svg;
  int size = 256, repeats = 5, reference_spp = 4096, most_spp = 256;
  double least_rmse = kImageTargets.back();
  std::size_t points = 1000, max_rays = 1024, ray_points = kRayPoints;
  bool quick = false;
  std::optional<float> footprint;  ///< none: the defaults
  RenderOptions render;

  [[nodiscard]] bool measures(const std::string& name) const {
    return protocol == "all" || protocol == name;
  }

  [[nodiscard]] std::vector<double> image_targets() const {
    std::vector<double> targets = kImageTargets;
    std::erase_if(targets, [this](double target) { return target < least_rmse; });
    return targets;
  }
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("SCENE", a.scenes, "glTF files or procedural scenes, \"scene:tree?leaves=50000\"")
      ->required();
  app.add_option("--opacity", a.opacity, "MATERIAL=VALUE: that opacity for a material; repeatable");
  app.add_option("--size", a.size, "Width and height of the pictures")->capture_default_str();
  app.add_option("--points", a.points, "Shading points, and triangles whose vertices are baked")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  app.add_option("--repeats", a.repeats, "Rounds of every measurement")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--reference-spp", a.reference_spp,
                 "Samples a pixel, and rays a point, of references")
      ->capture_default_str()
      ->check(CLI::Range(2, 1 << 20));
  app.add_option("--cache", a.cache, "Folder for references of pictures")->capture_default_str();
  app.add_option("--protocol", a.protocol, "What to measure")
      ->capture_default_str()
      ->check(CLI::IsMember({"points", "bake", "image", "rays", "all"}));
  app.add_option("--pass", a.pass, "Of pictures: which pass")
      ->capture_default_str()
      ->check(CLI::IsMember({"ao", "light", "all"}));
  app.add_option("--least-rmse", a.least_rmse, "Of pictures: contestants stop below this RMSE")
      ->capture_default_str()
      ->check(CLI::Range(kImageTargets.back(), kImageTargets.front()));
  app.add_option("--camera-splitting", a.render.camera_splitting,
                 "Of dapple's pictures: samples that share a camera ray; 0: as the scene suits");
  app.add_option("--footprint", a.footprint,
                 "dapple's footprint scale, of pictures and points (4 and 8)");
  app.add_option("--device", a.render.device, "Part of an OpenCL device's name");
  app.add_flag("--quick", a.quick, "A fraction of the work, to see whether all works");
  app.add_option("--json", a.json, "Write the figures as JSON");
  app.add_option("--svg", a.svg, "Plot errors against seconds");
  app.footer("Example:\n  dapple-bench rivals tree.glb --opacity leaf=0.85 --svg tree.svg");
}

void make_quick(Arguments& a) {
  a.size = std::min(a.size, 96);
  a.points = std::min<std::size_t>(a.points, 200);
  a.repeats = std::min(a.repeats, 3);
  a.reference_spp = std::min(a.reference_spp, 1024);
  a.most_spp = 64;
  a.max_rays = 256;
  a.ray_points = 2048;
}

void apply_options(Arguments& a) {
  if (a.quick) make_quick(a);
  a.render.width = a.render.height = a.size;
  if (a.footprint) a.render.footprint = *a.footprint;
  for (const std::string& text : a.opacity)
    a.render.opacity.push_back(parse_material_opacity(text));
  validate(a.render);
  if (!a.json.empty()) check_output_path(a.json);
  if (!a.svg.empty()) check_output_path(a.svg);
}

/// Shows the progress on a line that is overwritten. Prints nothing without a terminal.
void show_progress(const std::string& text) {
  if (!isatty(STDERR_FILENO)) return;
  fmt::print(stderr, "\r\033[K{}", text);
  std::fflush(stderr);
}

void show(const std::string& text) {
  show_progress("");
  fmt::print("{}\n", text);
  std::fflush(stdout);
}

/// Difference of dapple's exact values from Embree's reference.
std::string difference_text(const Truth& truth, const std::vector<double>& exact) {
  double sum = 0, square = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double difference = exact[i] - truth.values[i];
    sum += difference;
    square += difference * difference;
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, exact.size()));
  return fmt::format("exact with as many rays as the reference: mean {:+.4f}, RMSE {:.4f}",
                     sum / count, std::sqrt(square / count));
}

/// Runs the protocols for one scene and collects its report.
class SceneRun {
 public:
  SceneRun(const Arguments& arguments, const std::string& spec)
      : a_(arguments), scene_(spec, a_.render), figures_(building_json(scene_)) {
    show(building_text(scene_));
    points_ = visible_points(scene_.embree, scene_.camera, a_.ray_points);
    if (points_.empty())
      throw Error(ErrorKind::failed, spec + ": the camera sees nothing of the scene");
  }

  void measure() {
    if (a_.measures("rays") || a_.measures("points") || a_.measures("bake")) {
      const PreparedRays rays = prepare_rays(points_, kRaySeed);
      if (a_.measures("rays")) measure_all_rays(rays);
      if (a_.measures("points")) measure_points(calibrated_methods(scene_, rays));
      if (a_.measures("bake")) measure_bake(calibrated_methods(scene_, rays));
    }
    if (!a_.measures("image")) return;
    if (a_.pass != "light") measure_pictures(Pass::ao, "ao");
    if (a_.pass != "ao") measure_pictures(Pass::light, "light");
  }

  [[nodiscard]] const nlohmann::json& figures() const { return figures_; }
  [[nodiscard]] const std::vector<Plot>& plots() const { return plots_; }

 private:
  void measure_all_rays(const PreparedRays& rays) {
    show_progress("rays");
    const auto rows =
        measure_rays(scene_, rays, occlusion_methods(scene_.geometry.flat), true, a_.repeats);
    show(fmt::format("{} AO rays from {} points\n{}", rays.rays.size(), points_.size(),
                     rays_text(rows)));
    figures_["rays"] = rays_json(rows);
  }

  void measure_points(const std::vector<EmbreeMethod>& methods) {
    std::vector<Surface> points;
    const std::size_t count = std::min(a_.points, points_.size());
    for (std::size_t i = 0; i < count; ++i) points.push_back(points_[i * points_.size() / count]);
    show_progress("points: reference");
    const Truth truth = point_truth(scene_, points, static_cast<std::size_t>(a_.reference_spp));
    const PointQueries queries{a_.max_rays, a_.footprint.value_or(kOcclusionFootprint)};
    report(hold_contest(point_contestants(scene_, points, methods, queries), truth,
                        {a_.repeats, 0, show_progress}),
           kPointTargets, "points", fmt::format("AO at {} points", count), "rays a point");
  }

  void measure_bake(const std::vector<EmbreeMethod>& methods) {
    const std::vector<BakedPart> parts = choose_parts(scene_.ours.scene(), a_.points);
    show_progress("bake: reference");
    const Truth truth = bake_truth(scene_, parts, a_.reference_spp);
    const auto standings = hold_contest(bake_contestants(scene_, parts, methods), truth,
                                        {a_.repeats, kBakeTargets.back(), show_progress});
    report(standings, kBakeTargets, "bake",
           fmt::format("AO baked at {} vertices\n{}", truth.values.size(),
                       difference_text(truth, bake_exactly(scene_, parts, a_.reference_spp))),
           "effort");
  }

  void measure_pictures(Pass pass, const std::string& name) {
    ImageStudy study(scene_, pass, {a_.most_spp, a_.reference_spp, a_.cache});
    show_progress(name + ": reference");
    const Truth truth = study.truth();
    const auto contestants = study.contestants();
    const std::string title =
        fmt::format("{} pictures, {}x{}", name, scene_.view.width, scene_.view.height);
    report(hold_contest(contestants, truth, {a_.repeats, a_.least_rmse, show_progress}),
           a_.image_targets(), name,
           fmt::format("{} (Embree's camera rays: {})", title, study.methods()[0].camera.name()),
           "samples a pixel");
  }

  void report(const std::vector<Standing>& standings, const std::vector<double>& targets,
              const std::string& key, const std::string& title, const std::string& unit) {
    show(title + "\n" + contest_text(standings, targets, unit));
    figures_[key] = contest_json(standings, targets);
    plots_.push_back(contest_plot(standings, scene_.spec + ": " + title));
  }

  const Arguments& a_;
  RivalScene scene_;
  nlohmann::json figures_;
  std::vector<Surface> points_;
  std::vector<Plot> plots_;
};

}  // namespace

int run_rivals(int argc, char** argv) {
  Arguments a;
  CLI::App app("Embree and dapple side by side: rays a second and seconds to an error",
               "dapple-bench rivals");
  add_options(app, a);
  CLI11_PARSE(app, argc, argv);
  apply_options(a);
  nlohmann::json figures = nlohmann::json::array();
  std::vector<Plot> plots;
  for (const std::string& spec : a.scenes) {
    SceneRun run(a, spec);
    run.measure();
    figures.push_back(run.figures());
    plots.insert(plots.end(), run.plots().begin(), run.plots().end());
  }
  write_report(a.json, figures.dump(2) + "\n");
  write_report(a.svg, svg_text(plots));
  return 0;
}

}  // namespace dapple::bench
