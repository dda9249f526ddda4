#include "commands/bake/bake_arguments.hpp"

#include <fmt/format.h>

#include <set>
#include <sstream>

#include "commands/arguments/argument_errors.hpp"
#include "commands/arguments/choice.hpp"
#include "commands/arguments/option_text.hpp"
#include "commands/arguments/shared_options.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

void parse_bake_passes(const std::string& text, BakeOptions& options) {
  std::set<std::string> passes;
  std::istringstream list(text);
  for (std::string pass; std::getline(list, pass, ',');) passes.insert(pass);
  options.bent = passes.erase("bent") > 0;
  options.light = passes.erase("light") > 0;
  if (passes != std::set<std::string>{"ao"})
    throw Error(ErrorKind::usage,
                "--passes is \"" + text + "\"; it can be ao, with bent and light, by commas");
}

/// What is baked, and where in the file it goes.
void add_value_options(CLI::App& app, BakeArguments& a) {
  BakeOptions& o = a.options;
  app.add_option("SCENE", a.scene,
                 "glTF file (.gltf, .glb) or a procedural scene, \"scene:tree?leaves=50000\"")
      ->required();
  app.add_option("-o,--output", a.output,
                 "glTF file to write (.glb or .gltf): a copy of SCENE with the baked values")
      ->required();
  app.add_option("--to", a.to,
                 "vertex: values at vertices; texture: an occlusion texture; instance: a value for "
                 "each instance")
      ->capture_default_str();
  app.add_option("--passes", a.passes,
                 "ao, optionally with bent (bent normals: the mean unoccluded direction) and light "
                 "(irradiance "
                 "of each light), for example ao,bent,light")
      ->capture_default_str();
  app.add_option("--lights", a.lights, "JSON file of lights, in place of the scene's");
  app.add_option("--dome", a.dome,
                 "Environment map (.exr, .hdr) as a light, in addition to the others");
  add_rotation_option(app, "--dome-rotation", "dome", a.dome_rotation);
  add_light_radius_option(app, a.scene_options.light_radius);
  app.add_option(
         "--light-rays", o.light_rays,
         "Rays per light from each sample point and side. AO decides how many sample points "
         "there are")
      ->check(of_values("1..4096"))
      ->capture_default_str();
  app.add_option("--channel", a.channel,
                 "Where AO goes: COLOR_0.rgb, COLOR_0.r, .g, .b or .a, TEXCOORD_1.x or .y, or a "
                 "custom attribute, for example _AO. With --to instance: a custom attribute of "
                 "EXT_mesh_gpu_instancing; _COLOR_0 is a grey colour there. Default: COLOR_0.rgb; "
                 "with --to instance _AO");
  app.add_option("--bent-channel", a.bent_channel, "Where bent normals go: _BENT_NORMAL or NORMAL")
      ->capture_default_str();
  app.add_option("--size", o.texture_size, "Width and height of the texture")
      ->check(of_values("1..16384"))
      ->capture_default_str();
  app.add_option("--bits", a.bits, "Bits per texel of the occlusion texture: 8 or 16")
      ->check(CLI::IsMember({8, 16}))
      ->capture_default_str();
  app.add_option("--margin", o.margin,
                 "Texels by which values are extended beyond the border of each chart (UV island)")
      ->check(of_values("0..1024"))
      ->capture_default_str();
  app.add_option(
         "--uv", a.uv,
         "Texture coordinates. auto: the file's if they do not overlap, else new ones; own: always "
         "new ones")
      ->capture_default_str();
  app.add_option("--blend", a.blend,
                 "What to do with vertex colours that the file already has: multiply them by AO, "
                 "or replace "
                 "them")
      ->capture_default_str();
}

/// Which rays are traced, and which of their values count.
void add_ray_options(CLI::App& app, BakeArguments& a) {
  BakeOptions& o = a.options;
  app.add_option("--target-error", a.target_error,
                 "Trace rays until the standard error of each value is at most this. Lights: the "
                 "error of all together, divided by their largest irradiance without occlusion. "
                 "Default: 0.03, with at most 1024 rays")
      ->check(of_values("0..1"));
  app.add_option("--rays", a.rays,
                 "Number of rays per triangle (--at vertices: vertex; --to texture: texel) and "
                 "side, in place of the default --target-error. If both are given: the maximum")
      ->check(of_values("8..65536"));
  app.add_option(
         "--at", a.at,
         "Where rays start, for --to vertex. triangles: at points all over the triangles around a "
         "vertex; vertices: at the vertex itself")
      ->capture_default_str();
  app.add_option(
         "--sides", a.sides,
         "Side of a surface whose AO is stored. front; max: the brighter side; mean: the mean "
         "of both; auto: max for small sheets of double-sided materials, front for others")
      ->capture_default_str();
  app.add_option(
         "--instances", a.instances,
         "How meshes with several instances are baked. together: one value, the mean over the "
         "instances; unique: each instance gets its own copy of the mesh; alone: as if the "
         "rest of the scene did not exist")
      ->capture_default_str();
  app.add_option(
         "--normals", a.normals,
         "Around which rays are spread. shading: the normals of the meshes; geometric: those "
         "of the triangles")
      ->capture_default_str();
  add_prefiltering_options(app, a.estimator, o.footprint, a.report_bias);
  add_max_bias_option(app, o.max_bias);
  add_ao_range_options(app, o.distance, o.falloff);
  app.add_option("--seed", o.seed, "Seed of the random numbers: another seed gives other noise")
      ->capture_default_str();
}

/// The scene's changes, the device, and files beside the output.
void add_run_options(CLI::App& app, BakeArguments& a) {
  BakeOptions& o = a.options;
  add_opacity_option(app, a.opacity);
  app.add_option("--occluders", a.occluders,
                 "glTF files that occlude and are not baked: all files that follow, so SCENE comes "
                 "before it; may be repeated");
  app.add_flag("--ground", o.ground, "Put an opaque plane under the scene, which occludes it");
  add_outside_option(app, a.scene_options.allow_outside);
  add_device_options(app, o.device, o.kernel_dir, o.cache);
  CLI::Option& checkpoint = *app.add_option("--checkpoint", a.checkpoint,
                                            "Write what was traced so far to this file, for "
                                            "--resume: periodically, on interruption and at "
                                            "the end");
  app.add_option("--checkpoint-every", a.checkpoint_every,
                 "Time between two saves: 30 or 30s (seconds), 5m, 1h")
      ->capture_default_str()
      ->needs(&checkpoint);
  app.add_option("--resume", a.resume,
                 "Continue from this checkpoint, with the same scene and options");
  app.add_option("--png", a.png, "Also write a PNG of the scene, shaded by AO alone");
  add_report_options(app, a.stats_json, a.quiet);
}

}  // namespace

void add_bake_options(CLI::App& app, BakeArguments& a) {
  add_value_options(app, a);
  add_ray_options(app, a);
  add_run_options(app, a);
  app.footer(
      "Examples:\n  dapple bake tree.glb -o tree_ao.glb\n"
      "  dapple bake tree.glb -o tree_ao.glb --passes ao,bent --channel _AO --ground\n"
      "  dapple bake pine.glb -o pine_ao.glb --to texture --size 2048\n"
      "  dapple bake forest.glb -o forest_ao.glb --to instance");
}

void refuse_options_without_effect(const CLI::App& app, const BakeOptions& options) {
  const auto need = [&app](bool met, const char* needed, std::initializer_list<const char*> flags) {
    for (const char* flag : flags)
      if (!met && app.count(flag) > 0)
        throw Error(ErrorKind::usage, fmt::format("{} needs {}", flag, needed));
  };
  need(!options.texture, "--to vertex or instance", {"--channel"});
  need(options.vertices, "--to vertex", {"--bent-channel", "--blend", "--at"});
  need(!options.instances, "--to vertex or texture", {"--instances"});
  need(options.placement != BakePlacement::alone, "--instances together or unique",
       {"--occluders", "--ground"});
  need(options.texture, "--to texture", {"--size", "--bits", "--margin", "--uv"});
  need(options.bent, "--passes ao,bent", {"--bent-channel"});
  need(options.light, "--passes ao,light",
       {"--lights", "--dome", "--light-rays", "--light-radius"});
  need(app.count("--dome") > 0, "--dome", {"--dome-rotation"});
}

BakeOptions to_options(const BakeArguments& a) {
  BakeOptions o = a.options;
  enum class To { vertex, texture, instance };
  const To to = parse_choice<To>(
      "--to", a.to, {{"vertex", To::vertex}, {"texture", To::texture}, {"instance", To::instance}});
  o.vertices = to == To::vertex;
  o.texture = to == To::texture;
  o.instances = to == To::instance;
  parse_bake_passes(a.passes, o);
  dome_rotation("--dome-rotation", a.dome_rotation);
  o.at_vertices = parse_choice<bool>("--at", a.at, {{"triangles", false}, {"vertices", true}});
  o.sides = parse_choice<BakeSides>("--sides", a.sides,
                                    {{"auto", BakeSides::automatic},
                                     {"front", BakeSides::front},
                                     {"max", BakeSides::max},
                                     {"mean", BakeSides::mean}});
  o.placement = parse_choice<BakePlacement>("--instances", a.instances,
                                            {{"together", BakePlacement::together},
                                             {"unique", BakePlacement::together},
                                             {"alone", BakePlacement::alone}});
  parse_choice<bool>("--blend", a.blend, {{"multiply", true}, {"replace", false}});
  if (a.rays) o.rays = *a.rays;
  if (a.rays) o.target_error = 0;
  if (a.target_error) o.target_error = *a.target_error;
  o.estimator = parse_estimator(a.estimator);
  o.normals = parse_normals(a.normals);
  o.report_bias = parse_share("--report-bias", a.report_bias);
  for (const std::string& text : a.opacity) o.opacity.push_back(parse_opacity(text));
  if (o.instances && o.bent)
    throw Error(ErrorKind::usage,
                "--passes bent needs --to vertex or texture: an instance has one AO value");
  parse_choice<bool>("--uv", a.uv, {{"auto", false}, {"own", true}});
  channel_of(a);
  parse_choice<bool>("--bent-channel", a.bent_channel, {{"_BENT_NORMAL", false}, {"NORMAL", true}});
  validate(o);
  return o;
}

namespace {

BakeChannel parse_channel(const std::string& text, bool of_instances) {
  const std::size_t dot = text.find('.');
  const BakeChannel channel{text.substr(0, dot),
                            dot == std::string::npos ? "" : text.substr(dot + 1)};
  const auto& [attribute, components] = channel;
  const bool color =
      attribute == "COLOR_0" && (components == "rgb" || components == "r" || components == "g" ||
                                 components == "b" || components == "a");
  const bool uv = uv_set_of(attribute) && (components == "x" || components == "y");
  const bool custom = attribute.size() > 1 && attribute[0] == '_' && dot == std::string::npos &&
                      attribute != "_BENT_NORMAL";
  if (custom || (!of_instances && (color || uv))) return channel;
  if (of_instances)
    throw Error(ErrorKind::usage,
                fmt::format("--channel is \"{}\"; with --to instance it can be _AO, _COLOR_0 (a "
                            "grey colour) or another name that begins with _",
                            text));
  throw Error(ErrorKind::usage,
              fmt::format("--channel is \"{}\"; it can be COLOR_0.rgb, .r, .g, .b or .a, "
                          "TEXCOORD_1.x or .y, or a name that begins with _, such as _AO",
                          text));
}

}  // namespace

BakeChannel channel_of(const BakeArguments& a) {
  const bool of_instances = a.to == "instance";
  return parse_channel(a.channel.value_or(of_instances ? "_AO" : "COLOR_0.rgb"), of_instances);
}

std::optional<std::uint32_t> uv_set_of(const std::string& attribute) {
  constexpr std::string_view kPrefix = "TEXCOORD_";
  if (!attribute.starts_with(kPrefix) || attribute.size() != kPrefix.size() + 1) return {};
  const char digit = attribute.back();
  if (digit < '0' || digit > '9') return {};
  return static_cast<std::uint32_t>(digit - '0');
}

}  // namespace dapple
