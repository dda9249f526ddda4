#include "accuracy/picture_scene.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "device/context.hpp"
#include "passes/kernel_list.hpp"
#include "render/picture.hpp"

namespace dapple::bench {
namespace {

Scene prepared_scene(const std::string& spec, const RenderOptions& options, View& view) {
  Scene scene = load_scene(spec);
  for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
  std::vector<std::string> notes;
  view = choose_view(scene, options, notes);
  if (options.light && scene.lights.empty()) scene.lights.push_back(key_light(scene, view.camera));
  merge_single_instances(scene);
  return scene;
}

/// Returns planes of the film sums as means over samples. kernels/film/film.cl has their order.
class Sums {
 public:
  Sums(const TracedPicture& picture, const FilmLayout& layout)
      : picture_(picture), sums_(picture.sums.values<std::int64_t>()), layout_(layout) {}

  [[nodiscard]] std::vector<double> plane(std::uint32_t plane, double scale) const {
    std::vector<double> values(layout_.pixels);
    for (std::uint32_t p = 0; p < layout_.pixels; ++p)
      values[p] = static_cast<double>(sums_[std::size_t{plane} * layout_.pixels + p]) * scale /
                  picture_.samples[p];
    return values;
  }

 private:
  const TracedPicture& picture_;
  std::span<const std::int64_t> sums_;
  const FilmLayout& layout_;
};

/// Means over a pixel's samples. The value is 1 for samples that hit nothing.
std::vector<double> ao_values(const Sums& sums, const FilmLayout& layout,
                              const RenderOptions& options) {
  const std::vector<double> covered = sums.plane(0, 1.0);
  std::vector<double> values =
      sums.plane(layout.ao, 1.0 / (double{layout.unit_scale} * options.ao_rays));
  for (std::size_t p = 0; p < values.size(); ++p) values[p] += 1.0 - covered[p];
  return values;
}

double seconds_of(const std::map<std::string, double>& now,
                  const std::map<std::string, double>& before, const std::string& label) {
  const auto at = [&](const std::map<std::string, double>& map) {
    const auto found = map.find(label);
    return found == map.end() ? 0.0 : found->second;
  };
  return at(now) - at(before);
}

}  // namespace

std::pair<std::string, float> parse_material_opacity(const std::string& text) {
  const std::size_t at = text.rfind('=');
  const char* number = text.c_str() + (at == std::string::npos ? text.size() : at + 1);
  char* end = nullptr;
  const float value = std::strtof(number, &end);
  if (end == number || *end || at == 0)
    throw Error(ErrorKind::usage, "--opacity " + text + ": expected MATERIAL=VALUE");
  return {text.substr(0, at), value};
}

PictureScene::PictureScene(const std::string& spec, const RenderOptions& options)
    : options_(options), scene_(prepared_scene(spec, options, view_)), bvh_(build_bvh(scene_)) {}

void PictureScene::open() {
  if (device_) return;
  device_.emplace(options_.device, options_.kernel_dir);
  on_device_ = upload(*device_, scene_, bvh_);
}

std::string PictureScene::device_name() {
  open();
  return device_->info().name;
}

Picture PictureScene::render(const RenderOptions& asked) {
  RenderOptions chosen = asked;
  chosen.albedo = false;  // the scene is uploaded without colours
  chosen.camera_splitting = choose_camera_splitting(asked, scene_, view_);
  const RenderOptions options = by_sample(chosen);
  open();
  for (const KernelName& kernel :
       picture_kernels(device_->context(), options, view_.camera, scene_.lights))
    device_->context().prepare(kernel);
  const std::vector<Light> lights = options.light ? scene_.lights : std::vector<Light>{};
  const FilmLayout layout(view_.crop, options,
                          film_scales(view_, bvh_.bounds, on_device_.buffers->light_records),
                          lights);
  const auto start = std::chrono::steady_clock::now();
  const TracedPicture traced = trace_picture(*device_, on_device_, view_, options, layout, {});
  Picture picture;
  picture.trace_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto& seconds = device_->context().pass_seconds();
  picture.ao_seconds = seconds_of(seconds, seconds_before_, "ao occlusion");
  picture.light_seconds = seconds_of(seconds, seconds_before_, "light occlusion");
  seconds_before_ = seconds;

  const Sums sums(traced, layout);
  for (const double hits : sums.plane(0, 1.0)) picture.visible.push_back(hits > 0);
  if (options.ao) {
    picture.passes.push_back({"ao", ao_values(sums, layout, options)});
    picture.largest.push_back(1.0);
  }
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const double scale = 1.0 / (double{layout.lights[l].scale} * options.light_rays);
    const std::vector<double> unoccluded = sums.plane(layout.lights[l].unoccluded(), scale);
    const double largest = *std::max_element(unoccluded.begin(), unoccluded.end());
    picture.largest.push_back(largest);
    const std::size_t pass = picture.passes.size();
    const double divisor = pass < largest_.size() ? largest_[pass] : largest;
    picture.passes.push_back(
        {lights[l].name, sums.plane(layout.lights[l].first, divisor > 0 ? scale / divisor : 0.0)});
  }
  return picture;
}

}  // namespace dapple::bench
