// dapple points: sky and light at points, from a file or on a grid, into a file with columns.
#include "dapple/points.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/arguments/argument_errors.hpp"
#include "commands/arguments/option_text.hpp"
#include "commands/arguments/output_paths.hpp"
#include "commands/arguments/shared_options.hpp"
#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/progress.hpp"
#include "commands/statistics_text.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "points/point_file.hpp"
#include "points/point_sources.hpp"
#include "render/stopwatch.hpp"

namespace dapple {
namespace {

struct Arguments {
  std::string scene, output, at, suns, sky, lights, estimator = "prefiltered", stats_json;
  std::string report_bias = "2%";
  std::vector<double> grid, periodic;
  double height = 0, sky_rotation = 0;
  float sky_irradiance = 1;
  bool per_triangle = false, quiet = false, footprint_given = false;
  std::vector<std::string> opacity;
  SceneOptions scene_options;
  PointOptions options;
};

/// The scene, the output and where the points are.
void add_place_options(CLI::App& app, Arguments& a) {
  app.add_option("SCENE", a.scene,
                 "glTF file (.gltf, .glb), hair (.hair) or a procedural scene, "
                 "\"scene:tree?leaves=50000\"")
      ->required();
  app.add_option("-o,--output", a.output, "File to write: .csv, .npy or .ply")->required();
  app.add_option(
      "--at", a.at,
      "Points: .csv, .npy or .ply with columns x, y, z and optionally the normal nx, ny, nz. Give "
      "one of --at, --grid and --per-triangle");
  app.add_option("--grid", a.grid, "X0,Z0,X1,Z1,STEP: points on a horizontal grid, metres")
      ->delimiter(',')
      ->expected(5)
      ->allow_extra_args(false);
  app.add_option("--height", a.height, "Height of the grid, metres")->capture_default_str();
  app.add_flag("--per-triangle", a.per_triangle,
               "Two points at the centre of each triangle of the scene: its front, then its back");
}

/// What is written of each point.
void add_quantity_options(CLI::App& app, Arguments& a) {
  PointOptions& o = a.options;
  app.add_option(
         "--rays", o.rays,
         "Rays for each value of a point. They are divided into eight independent sets, from "
         "which the standard error is estimated")
      ->check(of_values("8..1048576"))
      ->capture_default_str();
  app.add_flag("--bent", o.bent, "Also write the mean unoccluded direction");
  app.add_option("--rings", o.rings,
                 "Also write gap fractions, the visible shares of the sky, in this many zenith "
                 "rings; 5 gives the rings of the LAI-2200 plant canopy analyser")
      ->check(of_values("0..90"));
  app.add_option("--suns", a.suns,
                 "CSV of suns: azimuth,elevation,irradiance (degrees from north, -Z, to east, +X; "
                 "degrees above the horizon; W/m^2 on a plane that faces the sun), or "
                 "x,y,z,irradiance with the direction towards the sun");
  app.add_flag("--per-sun", o.per_sun, "Write a column for each sun instead of their sum");
  app.add_option(
      "--sky", a.sky,
      "Also write the irradiance of a sky: uniform, overcast (CIE) or an image (.exr, .hdr)");
  app.add_option("--sky-irradiance", a.sky_irradiance,
                 "Irradiance of a uniform or overcast sky on an open horizontal plane, W/m^2; an "
                 "image keeps "
                 "its own")
      ->capture_default_str();
  add_rotation_option(app, "--sky-rotation", "image of --sky", a.sky_rotation);
  app.add_option("--lights", a.lights, "JSON file of lights, in place of the scene's");
  add_light_radius_option(app, a.scene_options.light_radius);
}

void add_point_options(CLI::App& app, Arguments& a) {
  add_place_options(app, a);
  add_quantity_options(app, a);
  PointOptions& o = a.options;
  app.add_option("--periodic", a.periodic,
                 "X,Z: the scene repeats itself with these periods, metres")
      ->delimiter(',')
      ->expected(2)
      ->allow_extra_args(false);
  add_opacity_option(app, a.opacity);
  app.add_flag("--ground", o.ground, "Put an opaque plane under the scene, which occludes it");
  add_ao_range_options(app, o.distance, o.falloff);
  add_prefiltering_options(app, a.estimator, o.footprint, a.report_bias)
      ->each([&a](const std::string&) { a.footprint_given = true; });
  app.get_option("--report-bias")
      ->description(
          "0: do not report the bias. Some 2,000 values of each column are traced exactly in any "
          "case, to correct the others");
  app.add_option("--max-bias", o.max_bias,
                 "Choose the largest footprint, from --footprint down to 0, whose bias is below "
                 "this in each column before it is corrected; 0: take --footprint. Without it and "
                 "--footprint: a smaller footprint if the correction leaves more in single values "
                 "than their noise")
      ->check(of_values("0..1"))
      ->type_name("FLOAT");
  app.add_option("--seed", o.seed, "Seed of the random numbers: another seed gives other noise")
      ->capture_default_str();
  add_outside_option(app, a.scene_options.allow_outside);
  add_device_options(app, o.device, o.kernel_dir, o.cache);
  add_report_options(app, a.stats_json, a.quiet);
  app.footer(
      "Columns: ao, sky_view_factor, the irradiance of each light, and what options add; each with "
      "its\n"
      "standard error NAME_error, except bent normals and single suns.\n\n"
      "Examples:\n  dapple points canopy.glb --grid 0,0,10,10,0.5 -o ground.csv --rings 5\n"
      "  dapple points canopy.glb --at sensors.csv -o light.csv --suns day.csv --sky overcast\n"
      "  dapple points plot.glb --per-triangle --periodic 10,10 -o leaves.npy");
}

/// Whether --sky is an image, not one of the skies by name.
bool names_image(const std::string& sky) {
  return !sky.empty() && sky != "uniform" && sky != "overcast";
}

PointList points_of(const Arguments& a, const Scene& scene) {
  const int sources = (a.at.empty() ? 0 : 1) + (a.grid.empty() ? 0 : 1) + (a.per_triangle ? 1 : 0);
  if (sources != 1)
    throw Error(ErrorKind::usage, "one of --at, --grid and --per-triangle says where points are");
  if (!a.at.empty()) return read_points(a.at);
  if (!a.grid.empty())
    return grid_points({a.grid[0], a.grid[1], a.grid[2], a.grid[3], a.grid[4]}, a.height);
  return triangle_points(scene);
}

Light sky_of(const Arguments& a) {
  if (!names_image(a.sky)) {
    Light sky = a.sky == "uniform" ? uniform_sky() : overcast_sky();
    sky.radiance *= a.sky_irradiance;
    return sky;
  }
  if (!std::filesystem::exists(a.sky))
    throw Error(ErrorKind::usage, fmt::format("--sky is {}; it must be uniform, overcast or an "
                                              "image file (.exr, .hdr)",
                                              a.sky));
  Light sky = dome_light("sky", a.sky);
  sky.rotation = dome_rotation("--sky-rotation", a.sky_rotation);
  return sky;
}

/// The sky comes first, so that it has the columns that its users expect.
void set_lights(const Arguments& a, Scene& scene) {
  if (!a.lights.empty()) use_lights(scene, load_lights(a.lights));
  if (a.sky.empty()) return;
  Light sky = sky_of(a);
  const bool is_taken =
      std::ranges::any_of(scene.lights, [&](const Light& light) { return light.name == sky.name; });
  if (is_taken)
    scene.warnings.push_back(fmt::format(
        "{0}_r, {0}_g and {0}_b are of --sky; the scene's own light of that name has a number",
        sky.name));
  scene.lights.insert(scene.lights.begin(), std::move(sky));
  for (Instance& instance : scene.instances) instance.light += instance.light >= 0 ? 1 : 0;
}

/// All input files, which no output may replace.
std::vector<std::string> files_read(const Arguments& a, const Scene& scene) {
  std::vector<std::string> files = scene.files;
  for (const std::string& path : {a.at, a.suns, a.lights})
    if (!path.empty()) files.push_back(path);
  if (names_image(a.sky)) files.push_back(a.sky);
  return files;
}

PointOptions options_of(const Arguments& a) {
  PointOptions options = a.options;
  options.estimator = parse_estimator(a.estimator);
  options.report_bias = parse_share("--report-bias", a.report_bias);
  if (a.footprint_given && !options.max_bias) options.max_bias = 0.0f;
  for (const std::string& text : a.opacity) options.opacity.push_back(parse_opacity(text));
  if (!a.periodic.empty()) {
    options.period_x = static_cast<float>(a.periodic[0]);
    options.period_z = static_cast<float>(a.periodic[1]);
    if (!(options.period_x > 0))
      throw Error(ErrorKind::usage, "--periodic needs two periods above 0");
  }
  if (!std::isfinite(a.height)) throw Error(ErrorKind::usage, "--height must be a finite number");
  if (options.per_sun && a.suns.empty()) throw Error(ErrorKind::usage, "--per-sun needs --suns");
  if (a.height != 0 && a.grid.empty()) throw Error(ErrorKind::usage, "--height needs --grid");
  if (!(a.sky_irradiance >= 0 && a.sky_irradiance <= 1e30f))
    throw Error(ErrorKind::usage, fmt::format("--sky-irradiance is {}; it must be from 0 to 1e+30",
                                              a.sky_irradiance));
  if (a.sky_irradiance != 1 && (a.sky.empty() || names_image(a.sky)))
    throw Error(ErrorKind::usage, "--sky-irradiance needs --sky uniform or overcast");
  dome_rotation("--sky-rotation", a.sky_rotation);
  if (a.sky_rotation != 0 && !names_image(a.sky))
    throw Error(ErrorKind::usage, "--sky-rotation needs --sky with an image");
  validate(options);
  return options;
}

/// Notes which columns of the file of points write_points() leaves out.
void note_replaced(const Arguments& a, const PointList& list, PointResult& result) {
  std::vector<std::string> names;
  for (const ExtraColumn& column : list.extra)
    if (std::ranges::count(result.columns, column.name, &PointColumn::name) > 0)
      names.push_back(column.name);
  if (names.empty()) return;
  const bool one = names.size() == 1;
  result.notes.push_back(fmt::format("{}: its column{} {} {} replaced by the result{} of {} name{}",
                                     a.at, one ? "" : "s", fmt::join(names, ", "),
                                     one ? "is" : "are", one ? "" : "s", one ? "that" : "these",
                                     one ? "" : "s"));
}

nlohmann::ordered_json statistics_of(const PointResult& result, std::size_t points,
                                     double load_seconds, double write_seconds, double seconds) {
  return {{"seconds",
           {{"load", load_seconds},
            {"prepare", result.prepare_seconds},
            {"build", result.build_seconds},
            {"trace", result.trace_seconds},
            {"write", write_seconds},
            {"total", seconds}}},
          {"points", points},
          {"footprint", result.footprint},
          {"bias", bias_json(result.bias)},
          {"device", result.device},
          {"notes", result.notes}};
}

void run_points(const Arguments& a) {
  PointOptions options = options_of(a);
  std::vector<OutputPath> outputs{{"--output", a.output}};
  if (!a.stats_json.empty()) outputs.push_back({"--stats-json", a.stats_json});
  check_outputs(outputs);
  check_point_output(a.output);
  catch_interruptions();
  const Stopwatch total;
  ProgressBar progress(a.quiet, "measuring");
  progress.announce("reading", a.scene);
  Scene scene = load_scene(a.scene, a.scene_options);
  check_outputs_spare(outputs, files_read(a, scene));
  if (names_image(a.sky)) progress.announce("reading", a.sky);
  set_lights(a, scene);
  check_outputs_spare(outputs, files_read(a, scene));  // and images of lights
  const PointList list = points_of(a, scene);
  std::vector<std::string> notes = list.notes;
  if (!a.suns.empty()) options.suns = read_suns(a.suns, &notes);
  const double load_seconds = total.seconds();
  progress.announce("building", "the BVH");
  RenderControl control;
  control.progress = progress.callback();
  PointResult result =
      measure_points(std::move(scene), list.points, list.normals, options, control);
  progress.clear();
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
  note_replaced(a, list, result);
  const Stopwatch writing;
  write_points(a.output, list, result.columns);
  const double write_seconds = writing.seconds(), seconds = total.seconds();
  if (!a.stats_json.empty())
    write_whole_file(a.stats_json, json_text(statistics_of(result, list.points.size(), load_seconds,
                                                           write_seconds, seconds)));
  if (a.quiet) return;
  for (const std::string& note : result.notes) tell("note: {}\n", note);
  if (!result.bias.empty()) put("means before their correction, RMSE after it:\n");
  put("{}{} points; load {:.2f}, prepare {:.2f}, build {:.2f}, trace {:.2f}, total {:.2f} s\n"
      "wrote {}\n",
      bias_lines(result.bias), list.points.size(), load_seconds, result.prepare_seconds,
      result.build_seconds, result.trace_seconds, seconds, a.output);
}

}  // namespace

Run add_points_command(CLI::App& app) {
  auto a = std::make_shared<Arguments>();
  add_point_options(app, *a);
  return [a] { run_points(*a); };
}

}  // namespace dapple
