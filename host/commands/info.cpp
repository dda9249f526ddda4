// dapple info: prints the contents of a scene, the cost of its BVH and its opacity.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "bvh/opacity/opacity_mip_levels.hpp"
#include "commands/arguments/option_text.hpp"
#include "commands/arguments/shared_options.hpp"
#include "commands/command.hpp"
#include "commands/render/shot.hpp"
#include "commands/statistics_text.hpp"
#include "commands/tell.hpp"
#include "dapple/bvh.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

struct InfoArguments {
  std::string scene;
  std::vector<std::string> opacity;
  SceneOptions scene_options;
  std::string cache, lights;
  bool json = false;
};

const char* name_of(LightKind kind) {
  switch (kind) {
    case LightKind::rect:
      return "rect";
    case LightKind::sphere:
      return "sphere";
    case LightKind::sun:
      return "sun";
    case LightKind::mesh:
      return "mesh";
    case LightKind::dome:
      return "dome";
    case LightKind::disk:
      return "disk";
  }
  return "";
}

nlohmann::ordered_json report(const Scene& scene, const SceneBvh& bvh) {
  const BvhStatistics& s = bvh.statistics;
  const auto primitives = std::max<std::size_t>(1, s.triangles + s.segments);
  const auto per_primitive = [&](std::size_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(primitives);
  };
  std::size_t textures = 0;
  if (!bvh.textured.empty()) {
    textures = scene.materials.size() * sizeof(MaterialRecord);
    for (const Texture& texture : scene.textures)
      textures += mip_level_texels(texture.width, texture.height);
  }
  const std::size_t nodes = bvh.nodes.size() * sizeof(BvhNode);
  const std::size_t triangles =
      bvh.blocks.size() * sizeof(TriangleBlock) + bvh.textured.size() * sizeof(TexturedTriangle);
  const std::size_t segments = bvh.segments.size() * sizeof(SegmentBlock);
  const std::size_t instances = bvh.instances.size() * sizeof(InstanceRecord);
  nlohmann::ordered_json json;
  json["scene"] = scene.source;
  json["triangles"] = {{"total", s.triangles},
                       {"opaque", s.opaque},
                       {"cut_out", s.cut_out},
                       {"translucent", s.translucent},
                       {"instanced", s.instanced_triangles}};
  json["segments"] = {{"total", s.segments}, {"instanced", s.instanced_segments}};
  json["instances"] = s.instances;
  json["materials"] = nlohmann::ordered_json::array();
  for (const Material& material : scene.materials) json["materials"].push_back(material.name);
  json["animations"] = nlohmann::ordered_json::array();
  for (const Animation& animation : scene.animations)
    json["animations"].push_back({{"name", animation.name}, {"seconds", animation.seconds}});
  json["lights"] = nlohmann::ordered_json::array();
  for (const Light& light : scene.lights)
    json["lights"].push_back({{"name", light.name}, {"kind", name_of(light.kind)}});
  json["cameras"] = nlohmann::ordered_json::array();
  for (const Camera& camera : scene.cameras) json["cameras"].push_back(camera.name);
  json["bounds"] = {{"min", {bvh.bounds.min.x, bvh.bounds.min.y, bvh.bounds.min.z}},
                    {"max", {bvh.bounds.max.x, bvh.bounds.max.y, bvh.bounds.max.z}}};
  json["nodes"] = bvh.nodes.size();
  json["bytes"] = {{"nodes", nodes},
                   {"triangles", triangles},
                   {"segments", segments},
                   {"textures", textures},
                   {"instances", instances}};
  // A segment counts as a triangle here.
  json["bytes_per_triangle"] = {
      {"nodes", per_primitive(nodes)},
      {"triangles", per_primitive(triangles + segments)},
      {"all", per_primitive(nodes + triangles + segments + textures + instances)}};
  json["seconds"] = {{"build", s.build_seconds + s.instance_seconds},
                     {"prefilter", s.prefilter_seconds}};
  json["sah_node_visits"] = s.sah_cost;
  json["lane_use"] = s.lane_use;
  json["opacity"] = {s.root_opacity[0], s.root_opacity[1], s.root_opacity[2]};
  json["warnings"] = scene.warnings;
  return json;
}

std::string names_text(const nlohmann::ordered_json& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text;
}

/// To five digits.
std::string point_text(const nlohmann::ordered_json& p) {
  return fmt::format("({:.5g}, {:.5g}, {:.5g})", p[0].get<double>(), p[1].get<double>(),
                     p[2].get<double>());
}

std::string report_text(const nlohmann::ordered_json& r) {
  const auto number = [&](const char* a, const char* b) { return r[a][b].get<double>(); };
  std::string text = fmt::format("{}\n", r["scene"].get<std::string>());
  text += fmt::format(
      "  triangles   {:.0f} ({:.0f} opaque, {:.0f} cut-out, {:.0f} translucent), {:.0f} with "
      "instances\n",
      number("triangles", "total"), number("triangles", "opaque"), number("triangles", "cut_out"),
      number("triangles", "translucent"), number("triangles", "instanced"));
  if (r["segments"]["total"] != 0) {
    text += fmt::format("  segments    {:.0f} of strands, {:.0f} with instances\n",
                        number("segments", "total"), number("segments", "instanced"));
  }
  text += fmt::format("  instances   {}\n", r["instances"].dump());
  text += fmt::format("  materials   {}\n", names_text(r["materials"]));
  if (!r["cameras"].empty()) text += fmt::format("  cameras     {}\n", names_text(r["cameras"]));
  std::string lights;
  for (const auto& light : r["lights"]) {
    lights += fmt::format("{}{} ({})", lights.empty() ? "" : ", ", light["name"].get<std::string>(),
                          light["kind"].get<std::string>());
  }
  if (!lights.empty()) text += fmt::format("  lights      {}\n", lights);
  std::string animations;
  for (const auto& animation : r["animations"]) {
    animations +=
        fmt::format("{}{} ({:.2f} s)", animations.empty() ? "" : ", ",
                    animation["name"].get<std::string>(), animation["seconds"].get<double>());
  }
  if (!animations.empty()) text += fmt::format("  animations  {}\n", animations);
  text += fmt::format("  bounds      {} to {} m\n", point_text(r["bounds"]["min"]),
                      point_text(r["bounds"]["max"]));
  text += fmt::format(
      "  nodes       {}, SAH {:.1f} node visits per ray, {:.0f} % of block lanes used\n",
      r["nodes"].dump(), r["sah_node_visits"].get<double>(), 100 * r["lane_use"].get<double>());
  text +=
      fmt::format("  memory      nodes {}, triangles {}, segments {}, textures {}, instances {}\n",
                  bytes_text(number("bytes", "nodes")), bytes_text(number("bytes", "triangles")),
                  bytes_text(number("bytes", "segments")), bytes_text(number("bytes", "textures")),
                  bytes_text(number("bytes", "instances")));
  text += fmt::format(
      "  size        {:.1f} bytes of nodes, {:.1f} of blocks, {:.1f} in all per {}\n",
      number("bytes_per_triangle", "nodes"), number("bytes_per_triangle", "triangles"),
      number("bytes_per_triangle", "all"), r["segments"]["total"] == 0 ? "triangle" : "primitive");
  text += fmt::format("  seconds     build {:.3f}, prefilter {:.3f}\n", number("seconds", "build"),
                      number("seconds", "prefilter"));
  text += fmt::format("  opacity     {:.3f}, {:.3f}, {:.3f} of the scene's box along x, y, z\n",
                      r["opacity"][0].get<double>(), r["opacity"][1].get<double>(),
                      r["opacity"][2].get<double>());
  for (const auto& warning : r["warnings"])
    text += fmt::format("  note        {}\n", warning.get<std::string>());
  return text;
}

void run_info(const InfoArguments& a) {
  if (!a.scene_options.animation.empty() && !a.scene_options.time)
    throw Error(ErrorKind::usage, "--animation needs --frame: which time to show");
  Scene scene = load_scene(a.scene, a.scene_options);
  for (const std::string& text : a.opacity) {
    const auto [material, value] = parse_opacity(text);
    override_opacity(scene, material, value);
  }
  if (!a.lights.empty()) use_lights(scene, load_lights(a.lights));
  merge_single_instances(scene);
  const auto json = report(scene, build_bvh(scene, a.cache));
  put("{}", a.json ? json_text(json) : report_text(json));
}

}  // namespace

Run add_info_command(CLI::App& app) {
  auto a = std::make_shared<InfoArguments>();
  app.add_option("SCENE", a->scene, "glTF file, .hair file or procedural scene")->required();
  add_opacity_option(app, a->opacity);
  app.add_option("--lights", a->lights, "JSON file of lights, in place of the scene's own");
  app.add_option("--frame", a->scene_options.time,
                 "Time to show, in seconds (not a frame number); default: the rest pose");
  app.add_option("--animation", a->scene_options.animation,
                 "The glTF animation that plays, by name; *: all at once; default: the first. "
                 "Needs --frame");
  app.add_option("--line-radius", a->scene_options.line_radius,
                 "Turn a glTF file's lines into strands of this radius, metres; 0: ignore them");
  app.add_flag("--allow-outside", a->scene_options.allow_outside,
               "Let a glTF file refer to buffers and images outside its folder");
  app.add_option("--cache", a->cache, "Keep built BVHs in this folder and reuse them");
  app.add_flag("--json", a->json, "Print JSON");
  app.footer("Example:\n  dapple info tree.glb --opacity leaf=0.85");
  return [a] { run_info(*a); };
}

}  // namespace dapple
