#include "commands/statistics_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "files/output_file.hpp"
#include "sampling/bias_estimate.hpp"

namespace dapple {
namespace {

std::string count_text(double count) {
  if (count >= 1e9) return fmt::format("{:.2f} G", count * 1e-9);
  if (count >= 1e6) return fmt::format("{:.2f} M", count * 1e-6);
  if (count >= 1e3) return fmt::format("{:.1f} k", count * 1e-3);
  return fmt::format("{:.0f} ", count);
}

double pass_seconds(const RenderStatistics& s, const std::string& label) {
  const auto found = s.pass_seconds.find(label);
  return found == s.pass_seconds.end() ? 0.0 : found->second;
}

std::string rays_line(const char* kind, std::uint64_t rays, double seconds, double visits,
                      double tests) {
  if (rays == 0) return {};
  const double count = static_cast<double>(rays);
  const std::string speed = seconds > 0 ? fmt::format("{}rays/s", count_text(count / seconds)) : "";
  return fmt::format(
      "  {:<7} {:>9}rays  {:>13}  {:5.1f} node visits, {:5.1f} triangle tests per ray\n", kind,
      count_text(count), speed, visits, tests);
}

/// Whether BVHs were built or read from the cache, in a few words; small objects do not count.
const char* bvh_source(const RenderStatistics& s) {
  if (s.refit.used) return s.refit.objects_rebuilt > 0 ? "rebuilt" : "refitted";
  const bool read = s.cache.objects_read > 0;
  if (read && s.cache.objects_written > 0) return "partly from cache";
  return read ? "from cache" : "built";
}

std::string cache_line(const RenderStatistics& s) {
  if (!s.cache.used) return {};
  return fmt::format("  bvh: {} (objects read {}, written {}), {:.2f} s saved\n", bvh_source(s),
                     s.cache.objects_read, s.cache.objects_written, s.cache.seconds_saved);
}

std::string refit_line(const RenderStatistics& s) {
  if (!s.refit.used) return {};
  return fmt::format(
      "  bvh: objects kept {}, refitted {}, rebuilt {} in {:.2f} s; SAH cost up to {:.2f} of the "
      "built trees'\n",
      s.refit.objects_kept, s.refit.objects_refitted, s.refit.objects_rebuilt, s.seconds.refit,
      s.refit.cost_ratio);
}

std::string seconds_line(const RenderStatistics& s) {
  const auto& t = s.seconds;
  const auto if_any = [](const char* step, double seconds) {
    return seconds > 0 ? fmt::format("{} {:.2f}, ", step, seconds) : "";
  };
  return fmt::format(
      "  seconds: load {:.2f}, prepare {:.2f}, cache {:.2f}, build {:.2f}, prefilter {:.2f}, {}"
      "upload {:.2f}, kernel build {:.2f}, trace {:.2f}, {}develop {:.2f}, write {:.2f}, total "
      "{:.2f}\n",
      t.load, t.prepare, t.cache, t.build, t.prefilter, if_any("refit", t.refit), t.upload,
      t.kernel_build, t.trace, if_any("checkpoint", t.checkpoint), t.develop, t.write, t.total);
}

std::string errors_line(const RenderStatistics& s) {
  std::string passes;
  for (const auto& [layer, value] : s.rmse) {
    passes += fmt::format("{}{} {:.4f}", passes.empty() ? "" : ", ", layer, value);
    const auto whole = s.rmse_with_bias.find(layer);
    if (whole != s.rmse_with_bias.end())
      passes += fmt::format(" (with bias {:.4f})", whole->second);
  }
  return passes.empty() ? "" : fmt::format("  estimated RMSE: {}\n", passes);
}

std::string largest_irradiance_line(const RenderStatistics& s) {
  std::string layers;
  for (const auto& [layer, value] : s.largest_irradiance)
    layers += fmt::format("{}{} {:.3g}", layers.empty() ? "" : ", ", layer, value);
  return layers.empty()
             ? ""
             : fmt::format("  errors and biases of lights are relative to, in W/m^2: {}\n", layers);
}

}  // namespace

std::string bias_lines(const std::map<std::string, Bias>& layers) {
  constexpr std::size_t kMost = 16;
  std::vector<std::pair<std::string, Bias>> largest(layers.begin(), layers.end());
  if (largest.size() > kMost)
    std::stable_sort(largest.begin(), largest.end(), [](const auto& a, const auto& b) {
      return std::abs(a.second.mean) > std::abs(b.second.mean);
    });
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, largest.size()); ++i)
    text += fmt::format("  bias of {}: {}\n", largest[i].first, bias_text(largest[i].second));
  if (largest.size() > kMost)
    text += fmt::format("  bias of {} other layers: at most {:.4f}; --stats-json F lists them\n",
                        largest.size() - kMost, std::abs(largest[kMost].second.mean));
  return text;
}

nlohmann::ordered_json bias_json(const std::map<std::string, Bias>& layers) {
  nlohmann::ordered_json json;
  for (const auto& [layer, bias] : layers)
    json[layer] = {{"mean", bias.mean},
                   {"error", bias.error},
                   {"tile_rmse", bias.tile_rmse},
                   {"tile_rmse_limit", bias.tile_rmse_limit},
                   {"share_of_rays", bias.share}};
  return json;
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string bytes_text(double bytes) {
  if (bytes >= 1e9) return fmt::format("{:.2f} GB", bytes * 1e-9);
  if (bytes >= 1e6) return fmt::format("{:.1f} MB", bytes * 1e-6);
  if (bytes >= 1e3) return fmt::format("{:.1f} kB", bytes * 1e-3);
  return fmt::format("{:.0f} bytes", bytes);
}

nlohmann::ordered_json statistics_json(const RenderStatistics& s) {
  nlohmann::ordered_json json;
  json["seconds"] = {{"load", s.seconds.load},           {"prepare", s.seconds.prepare},
                     {"cache", s.seconds.cache},         {"build", s.seconds.build},
                     {"prefilter", s.seconds.prefilter}, {"refit", s.seconds.refit},
                     {"upload", s.seconds.upload},       {"kernel_build", s.seconds.kernel_build},
                     {"trace", s.seconds.trace},         {"checkpoint", s.seconds.checkpoint},
                     {"develop", s.seconds.develop},     {"write", s.seconds.write},
                     {"total", s.seconds.total}};
  json["pass_seconds"] = s.pass_seconds;
  json["rays"] = {{"camera", s.rays.camera}, {"ao", s.rays.ao}, {"light", s.rays.light}};
  json["node_visits_per_ray"] = {
      {"camera", s.camera.visits}, {"ao", s.ao.visits}, {"light", s.light.visits}};
  json["triangle_tests_per_ray"] = {
      {"camera", s.camera.tests}, {"ao", s.ao.tests}, {"light", s.light.tests}};
  if (!s.rmse.empty()) json["estimated_rmse"] = s.rmse;
  if (!s.rmse_with_bias.empty()) json["estimated_rmse_with_bias"] = s.rmse_with_bias;
  if (!s.largest_irradiance.empty()) json["largest_irradiance"] = s.largest_irradiance;
  json["footprint"] = s.footprint;
  if (!s.bias.empty()) json["bias"] = bias_json(s.bias);
  json["triangles"] = s.triangles;
  json["segments"] = s.segments;
  json["nodes"] = s.nodes;
  json["bvh"] = bvh_source(s);
  if (s.cache.used) {
    json["cache"] = {{"objects_read", s.cache.objects_read},
                     {"objects_written", s.cache.objects_written},
                     {"seconds_saved", s.cache.seconds_saved}};
  }
  if (s.refit.used) {
    json["refit"] = {{"objects_kept", s.refit.objects_kept},
                     {"objects_refitted", s.refit.objects_refitted},
                     {"objects_rebuilt", s.refit.objects_rebuilt},
                     {"cost_ratio", s.refit.cost_ratio}};
  }
  json["bytes"] = {{"nodes", s.bytes.nodes},         {"triangles", s.bytes.triangles},
                   {"segments", s.bytes.segments},   {"textures", s.bytes.textures},
                   {"instances", s.bytes.instances}, {"film", s.bytes.film},
                   {"queues", s.bytes.queues}};
  json["device"] = s.device;
  json["estimator"] = s.estimator;
  json["notes"] = s.notes;
  return json;
}

void write_statistics(const RenderStatistics& statistics, const std::string& path) {
  write_whole_file(path, json_text(statistics_json(statistics)));
}

std::string statistics_text(const RenderStatistics& s) {
  const std::string segments = s.segments ? fmt::format("{} segments, ", s.segments) : "";
  std::string text = fmt::format("{} on {}: {} triangles, {}{} nodes\n", s.estimator, s.device,
                                 s.triangles, segments, s.nodes);
  text += rays_line("camera", s.rays.camera, pass_seconds(s, "camera"), s.camera.visits,
                    s.camera.tests);
  text += rays_line("ao", s.rays.ao, pass_seconds(s, "ao occlusion"), s.ao.visits, s.ao.tests);
  text += rays_line("light", s.rays.light, pass_seconds(s, "light occlusion"), s.light.visits,
                    s.light.tests);
  text += errors_line(s);
  text += bias_lines(s.bias);
  text += largest_irradiance_line(s);
  text += cache_line(s);
  text += refit_line(s);
  text += seconds_line(s);
  std::string passes;
  for (const auto& [label, seconds] : s.pass_seconds)
    passes += fmt::format("{}{} {:.2f}", passes.empty() ? "" : ", ", label, seconds);
  text += fmt::format("  device seconds: {}\n", passes);
  const auto& b = s.bytes;
  text += fmt::format(
      "  memory: nodes {}, triangles {}, {}textures {}, instances {}, film {}, queues {}\n",
      bytes_text(static_cast<double>(b.nodes)), bytes_text(static_cast<double>(b.triangles)),
      s.segments ? fmt::format("segments {}, ", bytes_text(static_cast<double>(b.segments))) : "",
      bytes_text(static_cast<double>(b.textures)), bytes_text(static_cast<double>(b.instances)),
      bytes_text(static_cast<double>(b.film)), bytes_text(static_cast<double>(b.queues)));
  return text;
}

}  // namespace dapple
