#include "rivals/rival_report.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "accuracy/report.hpp"
#include "rivals/embree/embree_trace.hpp"

namespace dapple::bench {
namespace {

using Cells = std::vector<std::vector<std::string>>;

/// Bytes per distinct triangle or segment: of the acceleration structure, and of all memory.
struct Bytes {
  double structure, all;
};

Bytes embree_bytes(const RivalScene& scene, const EmbreeScene& built) {
  const auto triangles = static_cast<double>(scene.geometry.triangles);
  const auto structure = static_cast<double>(built.bytes());
  return {structure / triangles,
          (structure + static_cast<double>(scene.geometry.bytes)) / triangles};
}

Bytes our_bytes(const SceneBvh& bvh) {
  const auto triangles = static_cast<double>(bvh.statistics.triangles + bvh.statistics.segments);
  const auto nodes = static_cast<double>(bvh.nodes.size() * sizeof(BvhNode));
  const auto rest = static_cast<double>(bvh.blocks.size() * sizeof(TriangleBlock) +
                                        bvh.segments.size() * sizeof(SegmentBlock) +
                                        bvh.textured.size() * sizeof(TexturedTriangle) +
                                        bvh.instances.size() * sizeof(InstanceRecord));
  return {nodes / triangles, (nodes + rest) / triangles};
}

std::size_t thread_count() {
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

std::string time_text(const std::optional<TimeToError>& time) {
  return time ? fmt::format("{:.4g}{}", time->seconds, time->extrapolated ? "*" : "") : "-";
}

std::string ratio_text(const std::optional<TimeToError>& embree,
                       const std::optional<TimeToError>& ours) {
  return embree && ours ? fmt::format("{:.2f}", embree->seconds / ours->seconds) : "-";
}

std::string rungs_text(const std::vector<Standing>& standings, const std::string& unit) {
  Cells cells{{"contestant", unit, "seconds", "spread", "RMSE", "mean error", "rounds"}};
  for (const Standing& standing : standings) {
    for (const Rung& rung : standing.rungs) {
      cells.push_back(
          {standing.name, fmt::format("{:g}", rung.effort), fmt::format("{:.4f}", rung.seconds),
           fmt::format("{:.0f} %", 100 * rung.spread), fmt::format("{:.4f}", rung.rmse),
           fmt::format("{:+.4f}", rung.mean_difference), fmt::format("{}", rung.rounds)});
    }
  }
  return table_text(cells);
}

}  // namespace

std::string building_text(const RivalScene& scene) {
  const BvhStatistics& ours = scene.ours.bvh().statistics;
  Cells cells{{"", "build s", "bytes a triangle", "with triangle data"}};
  const auto embree = [&](const char* name, const EmbreeScene& built) {
    const Bytes bytes = embree_bytes(scene, built);
    cells.push_back({name, fmt::format("{:.3f}", built.build_seconds()),
                     fmt::format("{:.1f}", bytes.structure), fmt::format("{:.1f}", bytes.all)});
  };
  embree("Embree medium", scene.embree.medium);
  embree("Embree high", scene.embree.high);
  const Bytes bytes = our_bytes(scene.ours.bvh());
  cells.push_back(
      {"dapple",
       fmt::format("{:.3f} + {:.3f} prefilter", ours.build_seconds, ours.prefilter_seconds),
       fmt::format("{:.1f}", bytes.structure), fmt::format("{:.1f}", bytes.all)});
  const unsigned units = scene.device.info().compute_units;
  return fmt::format(
      "{}, {} triangles and segments, {} placed; Embree {} with {} threads; {} with {} units{}\n{}",
      scene.spec, ours.triangles + ours.segments,
      ours.instanced_triangles + ours.instanced_segments, RTC_VERSION_STRING, thread_count(),
      scene.device.info().name, units,
      scene.device.info().kind == "CPU" && units != thread_count()
          ? "\nwarning: the two sides have different numbers of threads"
          : "",
      table_text(cells));
}

nlohmann::json building_json(const RivalScene& scene) {
  const BvhStatistics& ours = scene.ours.bvh().statistics;
  const auto embree = [&](const EmbreeScene& built) {
    const Bytes bytes = embree_bytes(scene, built);
    return nlohmann::json{{"build_seconds", built.build_seconds()},
                          {"structure_bytes_a_triangle", bytes.structure},
                          {"all_bytes_a_triangle", bytes.all}};
  };
  const Bytes bytes = our_bytes(scene.ours.bvh());
  return {{"scene", scene.spec},
          {"opacity", scene.options.opacity},
          {"triangles", ours.triangles},
          {"instanced_triangles", ours.instanced_triangles},
          {"segments", ours.segments},
          {"threads", thread_count()},
          {"device", scene.device.info().name},
          {"embree_medium", embree(scene.embree.medium)},
          {"embree_high", embree(scene.embree.high)},
          {"dapple",
           {{"build_seconds", ours.build_seconds},
            {"prefilter_seconds", ours.prefilter_seconds},
            {"node_bytes_a_triangle", bytes.structure},
            {"all_bytes_a_triangle", bytes.all}}}};
}

std::string rays_text(const std::vector<RayRow>& rows) {
  const double best = best_embree_rate(rows);
  Cells cells{{"rays", "Mray/s", "spread", "over Embree's best", "mean transmittance",
               "visits a ray", "tests a ray"}};
  for (const RayRow& row : rows) {
    cells.push_back({row.name, fmt::format("{:.2f}", row.rays_a_second * 1e-6),
                     fmt::format("{:.0f} %", 100 * row.spread),
                     fmt::format("{:.2f}", row.rays_a_second / best),
                     fmt::format("{:.4f}", row.mean_transmittance),
                     row.is_embree ? "" : fmt::format("{:.1f}", row.visits),
                     row.is_embree ? "" : fmt::format("{:.1f}", row.tests)});
  }
  return table_text(cells) + disagreements(rows);
}

nlohmann::json rays_json(const std::vector<RayRow>& rows) {
  nlohmann::json out = nlohmann::json::array();
  const double best = best_embree_rate(rows);
  for (const RayRow& row : rows) {
    out.push_back({{"contestant", row.name},
                   {"embree", row.is_embree},
                   {"rays_a_second", row.rays_a_second},
                   {"spread", row.spread},
                   {"over_best_embree", row.rays_a_second / best},
                   {"mean_transmittance", row.mean_transmittance}});
    if (!row.is_embree) {
      out.back()["visits_a_ray"] = row.visits;
      out.back()["tests_a_ray"] = row.tests;
    }
  }
  return out;
}

std::string contest_text(const std::vector<Standing>& standings, const std::vector<double>& targets,
                         const std::string& unit) {
  Cells cells{{"seconds to RMSE (Embree's best over it)"}};
  for (const double target : targets) {
    cells[0].push_back(fmt::format("{:g}", target));
    cells[0].emplace_back("ratio");
  }
  for (const Standing& standing : standings) {
    cells.push_back({standing.name});
    for (const double target : targets) {
      const auto time = time_to_error(standing, target);
      cells.back().push_back(time_text(time));
      cells.back().push_back(standing.is_embree ? ""
                                                : ratio_text(best_embree(standings, target), time));
    }
  }
  return rungs_text(standings, unit) + "\n" + table_text(cells) +
         disagreements(standings, kContestBlack);
}

nlohmann::json contest_json(const std::vector<Standing>& standings,
                            const std::vector<double>& targets) {
  nlohmann::json out = nlohmann::json::array();
  for (const Standing& standing : standings) {
    nlohmann::json rungs = nlohmann::json::array(), times = nlohmann::json::array();
    for (const Rung& rung : standing.rungs) {
      rungs.push_back({{"effort", rung.effort},
                       {"seconds", rung.seconds},
                       {"spread", rung.spread},
                       {"rmse", rung.rmse},
                       {"mean_difference", rung.mean_difference},
                       {"mean_difference_error", rung.mean_difference_error},
                       {"rounds", rung.rounds}});
    }
    for (const double target : targets) {
      const auto time = time_to_error(standing, target), embree = best_embree(standings, target);
      nlohmann::json& entry = times.emplace_back(nlohmann::json{{"rmse", target}});
      entry["seconds"] = time ? nlohmann::json(time->seconds) : nlohmann::json(nullptr);
      entry["extrapolated"] = time && time->extrapolated;
      entry["best_embree_over_it"] = time && embree
                                         ? nlohmann::json(embree->seconds / time->seconds)
                                         : nlohmann::json(nullptr);
    }
    out.push_back({{"contestant", standing.name},
                   {"embree", standing.is_embree},
                   {"rungs", rungs},
                   {"seconds_to_rmse", times}});
  }
  return out;
}

Plot contest_plot(const std::vector<Standing>& standings, const std::string& title) {
  Plot plot{title, "seconds", "RMSE", {}, true};
  for (std::size_t i = 0; i < standings.size(); ++i) {
    PlotLine line{standings[i].name, {}, standings[i].is_embree, static_cast<int>(i)};
    for (const Rung& rung : standings[i].rungs)
      line.points.push_back({rung.seconds, rung.rmse, ""});
    plot.lines.push_back(line);
  }
  return plot;
}

}  // namespace dapple::bench
