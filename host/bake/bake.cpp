// bake(): scene and options in, values at vertices, of a texture and of instances out. Read it from
// bottom to top.
#include "dapple/bake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "bake/bake_bias.hpp"
#include "bake/bake_checkpoint.hpp"
#include "bake/bake_pilot.hpp"
#include "bake/bake_settings.hpp"
#include "bake/inside/inside_samples.hpp"
#include "bake/instance_bake.hpp"
#include "bake/mesh_borders.hpp"
#include "bake/mesh_placements.hpp"
#include "bake/occluder_scene.hpp"
#include "bake/samples/expected_samples.hpp"
#include "bake/samples/light_tracer.hpp"
#include "bake/texture/texture_bake.hpp"
#include "bake/texture/texture_layout.hpp"
#include "bake/texture/texture_memory.hpp"
#include "bake/two_sided.hpp"
#include "bake/vertex_bake.hpp"
#include "dapple/error.hpp"
#include "film/light_layers.hpp"
#include "film/memory_limit.hpp"
#include "render/option_check.hpp"
#include "render/stopwatch.hpp"
#include "scene/check/scene_check.hpp"

namespace dapple {
namespace {

/// The share of the surface without area in given texture coordinates from which on a note says so.
constexpr double kNotedShare = 0.0005;

/// The share of values above the target error from which on a note says so.
constexpr double kNotedAbove = 0.005;

TracePoints trace_against(const OccluderScene& occluders) {
  return [&occluders](const QueryPoints& points, const OcclusionOptions& options, bool bent) {
    return point_occlusion(occluders.device, occluders.uploaded, points, options, bent);
  };
}

/// Who is told about the samples that are traced.
struct BakeRecords {
  BakeProgress& progress;
  BakeCheckpoint& checkpoint;
  BakeBias& bias;
  BakeStatistics& statistics;
};

/// Options of rays that are compared with others.
struct ComparedOptions {
  explicit ComparedOptions(const BakeOptions& options) : prefiltered(options), exact(options) {
    prefiltered.bent = exact.bent = false;
    exact.estimator = Estimator::exact;
  }
  BakeOptions prefiltered, exact;
};

/// The options must outlive the tracing.
BakeTracing tracing_against(const OccluderScene& occluders, const BakeOptions& options,
                            const ComparedOptions& compared, const BakeRecords& records) {
  const TracePoints trace = trace_against(occluders);
  if (records.bias.compares()) occluders.closed->prepare();  // not in the time of comparing
  const auto recorded = [&](TraceSamples values) {
    return telling_inside(records.checkpoint.with(std::move(values)), *occluders.closed);
  };
  const auto quantity = [&](BiasTracing tracing) -> QuantityTracing {
    TraceSamples of_check = recorded(tracing.values);
    tracing.exact = telling_inside(std::move(tracing.exact), *occluders.closed);
    return {recorded(records.bias.with(std::move(tracing))), std::move(of_check)};
  };
  BakeTracing tracing{
      quantity({"ao", ao_tracer(trace, options), ao_tracer(trace, compared.prefiltered),
                ao_tracer(trace, compared.exact)}),
      {},
      0,
      records.progress,
      records.statistics};
  if (!options.light || occluders.lights.empty()) return tracing;
  tracing.light = quantity({"light", light_tracer(options, occluders),
                            light_tracer(compared.prefiltered, occluders),
                            light_tracer(compared.exact, occluders)});
  tracing.lights = occluders.lights.size();
  return tracing;
}

/// Chooses the footprint and what the target leaves for the noise, from the bias of `meshes`.
void measure_bias(const OccluderScene& occluders, const std::vector<PilotMesh>& meshes,
                  BakeOptions& options, BakeStatistics& statistics) {
  if (!has_bias(options) || meshes.empty()) return;
  if (options.max_bias <= 0 && options.target_error <= 0) return;
  const ComparedOptions compared(options);
  std::vector<BakeOptions> scaled;  // those that tracers refer to
  scaled.reserve(16);
  const auto with_footprint = [&](float footprint) -> const BakeOptions& {
    BakeOptions& added = scaled.emplace_back(compared.prefiltered);
    added.footprint = footprint;
    return added;
  };
  const TracePoints trace = trace_against(occluders);
  std::vector<PilotQuantity> quantities{
      {kRaysPerSample, telling_inside(ao_tracer(trace, compared.exact), *occluders.closed),
       [&](float footprint) { return ao_tracer(trace, with_footprint(footprint)); }}};
  if (options.light && !occluders.lights.empty())
    quantities.push_back(
        {options.light_rays,
         telling_inside(light_tracer(compared.exact, occluders), *occluders.closed),
         [&](float footprint) { return light_tracer(with_footprint(footprint), occluders); }});
  BakePilot pilot(meshes, std::move(quantities), options.seed);
  const FootprintChoice choice =
      choose_footprint(pilot, {options.footprint, options.max_bias, options.target_error, true});
  options.footprint = choice.footprint;
  if (options.target_error > 0)
    options.target_error = noise_target(options.target_error, choice.bias_rmse);
  if (!choice.note.empty()) statistics.notes.push_back(choice.note);
}

/// Adds up the lights of each group. `lights`: those that were traced.
void add_up_groups(const std::vector<Light>& lights, BakeResult& result) {
  const std::vector<LightLayer> layers = light_layers(lights);
  for (const LightLayer& layer : layers) result.light_names.push_back(layer.name);
  for (BakedMesh& mesh : result.meshes)
    if (!mesh.light.empty()) mesh.light = sums_of_layers(layers, mesh.light);
  if (!result.texture.light.empty())
    result.texture.light = sums_of_layers(layers, result.texture.light);
  if (!result.instance_light.empty())
    result.instance_light = sums_of_layers(layers, result.instance_light);
}

double prepared_seconds(const BakeStatistics& s) {
  return s.seconds.prepare + s.seconds.build + s.seconds.upload + s.seconds.kernel_build;
}

/// `seconds`: since the occluders began to be prepared.
void add_preparation(const OccluderScene& occluders, double seconds, BakeStatistics& s) {
  const double before = prepared_seconds(s);
  s.seconds.build += occluders.build_seconds;
  s.seconds.upload += occluders.upload_seconds;
  s.seconds.kernel_build += occluders.kernel_seconds;
  s.seconds.prepare += seconds - (prepared_seconds(s) - before);
  s.device = occluders.device.info().name;
}

/// To be called once, when all is traced.
void add_pass_seconds(const Device& device, BakeStatistics& s) {
  for (const auto& [label, seconds] : device.context().pass_seconds())
    s.pass_seconds[label] += seconds;
}

/// Traces against the whole scene, or against each mesh alone.
class MeshOccluders {
 public:
  /// `options`: those that are traced with. With meshes alone each one's bias is measured anew.
  MeshOccluders(const Device& device, const Scene& scene, const BakeOptions& options,
                const OccluderScene* together)
      : device_(device),
        scene_(scene),
        two_sided_(scene, options.sides),
        asked_(options),
        options_(options),
        together_(together) {}

  /// Valid until the next call.
  BakeTracing tracing(std::uint32_t mesh, const BakeRecords& records) {
    if (!together_) {
      const Stopwatch preparing;
      options_ = asked_;
      alone_.emplace(device_, scene_of_mesh(scene_, mesh), options_, std::vector<Scene>{});
      add_preparation(*alone_, preparing.seconds(), records.statistics);
      measure_bias(*alone_, {PilotMesh(scene_.meshes[mesh], two_sided_, options_, placed_alone())},
                   options_, records.statistics);
    }
    compared_.emplace(options_);
    return tracing_against(together_ ? *together_ : *alone_, options_, *compared_, records);
  }

  /// Of the last mesh.
  [[nodiscard]] float footprint() const { return options_.footprint; }

 private:
  const Device& device_;
  const Scene& scene_;
  const TwoSided two_sided_;
  const BakeOptions asked_;
  BakeOptions options_;
  std::optional<ComparedOptions> compared_;
  const OccluderScene* together_;
  std::optional<OccluderScene> alone_;
};

/// Calls bake(mesh, placements) for all meshes that can be baked. False: one returned false.
template <class BakeOne>
bool for_each_mesh(const Scene& scene, const BakeOptions& options, BakeOne bake_one) {
  const std::vector<Placements> placements = placements_by_mesh(scene, options.placement);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (mesh.has_strands() || mesh.primitive_count() == 0 || placements[m].to_world.empty())
      continue;
    if (!bake_one(m, placements[m])) return false;
  }
  return true;
}

/// Those that for_each_mesh() visits, in their surroundings.
std::vector<PilotMesh> pilot_meshes(const Scene& scene, BakeOptions options) {
  if (options.placement == BakePlacement::alone) options.placement = BakePlacement::together;
  const TwoSided two_sided(scene, options.sides);
  std::vector<PilotMesh> meshes;
  for_each_mesh(scene, options, [&](std::uint32_t m, const Placements& placements) {
    meshes.emplace_back(scene.meshes[m], two_sided, options, placements);
    return true;
  });
  return meshes;
}

bool bake_vertices(const Scene& scene, const BakeOptions& options, MeshOccluders& occluders,
                   const BakeRecords& records, BakeResult& result) {
  result.meshes.resize(scene.meshes.size());
  const TwoSided two_sided(scene, options.sides);
  const auto bake_one = [&](std::uint32_t m, const Placements& placements) {
    BakeTracing tracing = occluders.tracing(m, records);
    const Mesh& mesh = scene.meshes[m];
    auto baked = bake_mesh(mesh, two_sided.triangles(mesh), m, placements, options, tracing);
    if (baked) result.meshes[m] = std::move(*baked);
    return baked.has_value();
  };
  if (!for_each_mesh(scene, options, bake_one)) return false;
  if (options.placement == BakePlacement::together) join_borders(scene, two_sided, result);
  return true;
}

bool bake_texture(const Scene& scene, const BakeOptions& options, MeshOccluders& occluders,
                  const BakeRecords& records, BakeResult& result) {
  const std::vector<std::vector<V2f>>& uvs = options.texture_uvs;
  TextureLayout layout = uvs.empty() ? make_layout(scene, options) : given_layout(scene, options);
  const std::size_t lights = (options.lights ? *options.lights : scene.lights).size();
  check_texture_memory(layout, options, lights, machine_bytes());
  TextureBake texture(scene, options, std::move(layout));
  const double lost =
      uvs.empty() ? 0.0 : share_without_texels(scene, uvs, options.texture_size, options.placement);
  if (lost >= kNotedShare)
    records.statistics.notes.push_back(fmt::format(
        "{:.1f} % of the surface has no area in the texture, and no values there", 100 * lost));
  const bool done =
      for_each_mesh(scene, options, [&](std::uint32_t m, const Placements& placements) {
        BakeTracing tracing = occluders.tracing(m, records);
        return texture.add(m, placements, tracing);
      });
  if (done) result.texture = texture.finish(records.statistics);
  return done;
}

bool bake_all_instances(const Scene& scene, const BakeOptions& options,
                        const OccluderScene& together, const BakeRecords& records,
                        BakeResult& result) {
  const ComparedOptions compared(options);
  BakeTracing tracing = tracing_against(together, options, compared, records);
  auto values = bake_instances(scene, options, tracing);
  if (!values) return false;
  result.instance_ao = std::move(values->ao);
  result.instance_light = std::move(values->light);
  return true;
}

/// Says how many values have a larger error than the target, where these are not very few.
/// Meshes that get no values. `vanished`: these count, too.
void note_left_out(const Scene& scene, bool vanished, std::vector<std::string>& notes) {
  const auto note = [&](std::ptrdiff_t count, const char* which) {
    if (count > 0)
      notes.push_back(fmt::format("{} mesh{} {}: not baked", count, count == 1 ? "" : "es", which));
  };
  note(std::ranges::count_if(scene.meshes, &Mesh::has_strands), "of strands");
  if (!vanished)
    note(static_cast<std::ptrdiff_t>(count_vanished_meshes(scene)),
         "without an instance whose matrix can be inverted");
}

void add_target_notes(const BakeOptions& asked, BakeStatistics& s) {
  const auto add = [&](const TargetStatistics& counts, const char* of) {
    const auto all = static_cast<double>(counts.values);
    if (counts.above == 0 || static_cast<double>(counts.above) < kNotedAbove * all) return;
    s.notes.push_back(fmt::format(
        "{:.1f} % of the values{} have an error above --target-error {}: the limit "
        "is --rays {}",
        100 * static_cast<double>(counts.above) / all, of, asked.target_error, asked.rays));
  };
  add(s.ao_target, "");
  add(s.light_target, " of light");
}

}  // namespace

void validate(const BakeOptions& options) {
  check_range("--rays", options.rays, kRaysPerSample, 65536);
  check_range("--light-rays", options.light_rays, 1, 4096);
  check_range("--size", double{1.0 * options.texture_size}, 1, 16384);
  check_range("--margin", options.margin, 0, 1024);
  check_range("--target-error", double{options.target_error}, 0, 1);
  check_ray_options(options);
  check_enumerator("--sides", options.sides, BakeSides::mean);
  check_enumerator("--instances", options.placement, BakePlacement::alone);
  check_enumerator("--normals", options.normals, Normals::geometric);
  check_range("--max-bias", double{options.max_bias}, 0, 1);
  if (options.light && options.placement == BakePlacement::alone)
    throw Error(ErrorKind::usage,
                "--passes light needs --instances together or unique: a mesh alone is not lit");
  if (options.ground && options.placement == BakePlacement::alone &&
      (options.vertices || options.texture))
    throw Error(ErrorKind::usage,
                "--ground needs --instances together or unique: a mesh alone stands on none");
  if (!options.vertices && !options.texture && !options.instances)
    throw Error(ErrorKind::usage,
                "nothing is baked: values of vertices, of a texture or of instances");
}

BakeResult bake(const Scene& scene, const BakeOptions& asked, const RenderControl& control,
                const std::vector<Scene>& occluders) {
  validate(asked);
  const std::vector<Light>& lights = asked.lights ? *asked.lights : scene.lights;
  if (asked.light && lights.empty())
    throw Error(ErrorKind::usage,
                fmt::format("--passes light: {}; --lights or --dome brings some",
                            asked.lights ? "there are no lights" : "the scene has no lights"));
  const bool alone = asked.placement == BakePlacement::alone;
  if (alone && (asked.vertices || asked.texture) && !occluders.empty())
    throw Error(ErrorKind::usage,
                "--occluders needs --instances together or unique: a mesh alone has none");
  BakeOptions options = asked;
  const Stopwatch total;
  BakeResult result;
  BakeStatistics& s = result.statistics;
  const Device device(options.device, options.kernel_dir);
  std::optional<OccluderScene> together;
  if (!alone || options.instances) {
    together.emplace(device, scene, options, occluders);
    add_preparation(*together, total.seconds(), s);
    s.notes = together->notes;
  } else {
    check_scene(scene);
    s.notes = scene.warnings;
  }
  note_left_out(scene, alone || options.instances, s.notes);
  BakeProgress progress(expected_samples(scene, options), control);
  Settings settings = bake_settings(scene, asked, occluders);
  if (together) settings.emplace_back("device", s.device);
  BakeCheckpoint checkpoint(control, std::move(settings));
  s.seconds.prepare += total.seconds() - prepared_seconds(s);
  if (together) measure_bias(*together, pilot_meshes(scene, options), options, s);
  BakeBias bias(has_bias(options) ? double{options.report_bias} : 0.0);
  const BakeRecords records{progress, checkpoint, bias, s};
  MeshOccluders mesh_occluders(device, scene, alone ? asked : options,
                               alone ? nullptr : &*together);
  if (options.vertices)
    result.interrupted = !bake_vertices(scene, options, mesh_occluders, records, result);
  if (options.texture && !result.interrupted)
    result.interrupted = !bake_texture(scene, options, mesh_occluders, records, result);
  if (options.instances && !result.interrupted)
    result.interrupted = !bake_all_instances(scene, options, *together, records, result);
  if (options.light && !result.interrupted) add_up_groups(together->lights, result);
  if (!result.interrupted) progress.finish();
  if (options.max_bias > 0 && !has_bias(asked)) s.notes.emplace_back(kNothingToLimit);
  s.bias = bias.report();
  s.footprint = together ? options.footprint : mesh_occluders.footprint();
  add_target_notes(asked, s);
  checkpoint.save(true);
  result.checkpoint_failure = checkpoint.failure();
  if (checkpoint.points_read() > 0)
    s.notes.push_back(fmt::format("went on from {}: {} of {} points", control.resume,
                                  checkpoint.points_read(), s.points));
  add_pass_seconds(device, s);
  s.seconds.total = total.seconds();
  s.seconds.trace = s.seconds.total - prepared_seconds(s);
  return result;
}

}  // namespace dapple
