#include "render/picture.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "camera/camera_splitting.hpp"
#include "passes/camera_pass.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/queues.hpp"
#include "passes/ray_packets.hpp"
#include "passes/resolve_pass.hpp"
#include "passes/shading_pass.hpp"
#include "render/back_slices.hpp"
#include "render/bias/bias_report.hpp"
#include "render/bias/bias_tracer.hpp"
#include "render/picture_rays.hpp"
#include "render/slice_params.hpp"
#include "sampling/film_moments.hpp"
#include "sampling/sample_plan.hpp"

namespace dapple {
namespace {

class PictureTracer {
 public:
  PictureTracer(const Device& device, const DeviceScene& scene, const View& view,
                const RenderOptions& options, const FilmLayout& layout, TraceState state,
                const HitLookups& lookups)
      : context_(device.context()),
        scene_(*scene.buffers),
        options_(options),
        layout_(layout),
        rays_(context_, scene_, view, options, layout),
        light_count_(layout.lights.size()),
        width_(view.crop.width()),
        camera_(camera_params(view, options, scene_.bounds)),
        state_(std::move(state)),
        looks_up_hits_(lookups.any()),
        hit_sums_(lookups, layout.pixels, state_.first_sample) {
    camera_.keep_hits = layout.shading() || looks_up_hits_;
    if (looks_up_hits_) camera_.medium_error = 0;  // a medium's surfaces belong to no primitive
    const auto rays = static_cast<std::size_t>(
        std::max(options.ao ? options.ao_rays : 1, light_count_ ? options.light_rays : 1));
    std::uint32_t& samples = state_.slice_samples;
    if (samples == 0)
      samples = samples_of_slice(device.info(), options, light_count_, rays, layout.pixels);
    queues_ = make_queues(context_, state_.slice_samples, rays);
    queues_.work = context_.allocate(layout.pixels * sizeof(PixelWork));
    queues_.albedo = context_.allocate(layout.albedo ? samples * sizeof(SampleAlbedo) : 0);
    film_.sums = context_.allocate_zeros(layout.sum_bytes());
    film_.squares = context_.allocate_zeros(layout.square_bytes());
    if (has_bias(options) && options.report_bias > 0) {
      begin_bias_sums();
      bias_.emplace(context_, scene_, options, view, layer_count(), std::move(state_.bias));
    }
    place_sums();
    resolve_ = resolve_params(view, layout, camera_.splitting_bits);
    resolve_.first_sample = state_.first_sample;
    if (options.back)
      backs_.emplace(context_, queues_, state_.slice_samples,
                     back_params(view, options, layout, resolve_));
  }

  TracedPicture trace(const View& view, const TraceControl& control) {
    SamplePlan plan(width_, static_cast<int>(layout_.pixels) / width_, options_, state_.samples,
                    state_.first_sample);
    traced_ = sum_of(traced_samples(state_.round, state_.slice_samples, plan.samples()));
    saved_samples_ = traced_;
    TracedPicture picture;
    while (!picture.interrupted && (!state_.round.is_done() || next_round(plan, control))) {
      picture.interrupted = !trace_round(plan, control);
      trace_backs();
    }
    if (!picture.interrupted && control.progress) control.progress(1);
    keep_state(plan, control, !picture.interrupted);
    picture.samples = traced_samples(state_.round, state_.slice_samples, plan.samples());
    picture.skipped = picture.interrupted && control.skip_film && control.skip_film();
    if (!picture.skipped) add_sums(picture, plan, view);
    context_.finish();
    picture.pass_seconds = pass_seconds();
    picture.queue_bytes = queues_.bytes() + (backs_ ? backs_->bytes() : 0);
    return picture;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void add_sums(TracedPicture& picture, const SamplePlan& plan, const View& view) {
    if (plan.is_adaptive() && all_have_variances(picture.samples))
      picture.errors = standard_errors(picture.samples);
    picture.sums = context_.view(film_.sums);
    if (bias_ || !picture.errors.empty()) picture.largest = largest_values(picture);
    if (bias_) picture.bias = bias_of(picture, view);
    picture.mattes = std::move(hit_sums_.mattes);
    picture.motion = std::move(hit_sums_.motion);
    picture.deep = std::move(hit_sums_.deep);
  }

  static double sum_of(const std::vector<std::uint32_t>& samples) {
    return static_cast<double>(std::accumulate(samples.begin(), samples.end(), std::uint64_t{0}));
  }

  /// Whether every pixel has the two batches that a variance needs.
  static bool all_have_variances(const std::vector<std::uint32_t>& samples) {
    return *std::min_element(samples.begin(), samples.end()) >= 2 * DAPPLE_SAMPLE_BATCH;
  }

  /// Moves the state's sums and squares to the device.
  void place_sums() {
    earlier_seconds_ = state_.pass_seconds;
    for (const auto& [label, seconds] : context_.pass_seconds()) earlier_seconds_[label] -= seconds;
    hit_sums_.take_from(state_);
    if (state_.sums.empty()) return;
    context_.write(film_.sums, state_.sums.data(), layout_.sum_bytes());
    if (!state_.squares.empty())
      context_.write(film_.squares, state_.squares.data(), layout_.square_bytes());
    release_sums();
  }

  void release_sums() {
    state_.sums = {};
    state_.squares = {};
    state_.device_sums = state_.device_squares = {};
    state_.mattes = {};
    state_.motion = MotionSums();
    state_.deep = DeepSums();
    state_.bias = {};
  }

  [[nodiscard]] std::size_t layer_count() const {
    return ((options_.ao ? 1 : 0) + light_count_) * (options_.back ? 2 : 1);
  }

  /// Samples of earlier runs are not in the sums, unless the state has these.
  void begin_bias_sums() {
    if (!state_.bias.differences.empty() || state_.samples.empty()) return;
    state_.bias.earlier = traced_samples(state_.round, state_.slice_samples, state_.samples);
  }

  // Without a target states have no squares, and those of earlier runs and moments are missing:
  // then the largest irradiance counts less of its noise.
  std::vector<double> largest_values(const TracedPicture& picture) {
    const HostView squares = context_.view(film_.squares);
    return FilmMoments(picture.sums, squares, layout_, options_, picture.samples, width_)
        .largest_values();
  }

  PictureBias bias_of(const TracedPicture& picture, const View& view) {
    bias_->finish();
    const SideSamples taken = samples_of_bias(bias_->sums(), picture.sums, picture.samples, layout_,
                                              backs_ ? backs_->choice().group_bits : 0);
    return picture_bias(bias_->sums(), picture.sums, taken, layout_, view, picture.largest);
  }

  void read_state(const SamplePlan& plan) {
    context_.finish();
    hit_sums_.copy_to(state_);
    if (bias_) {
      bias_->finish();
      state_.bias = bias_->sums();
    }
    state_.samples = plan.samples();
    state_.pass_seconds = pass_seconds();
    state_.device_sums = context_.view(film_.sums);
    // Without a target nobody reads them, and they depend on the order of samples.
    if (plan.is_adaptive()) state_.device_squares = context_.view(film_.squares);
  }

  /// Device seconds of this picture, in this run and in the runs that it resumes.
  [[nodiscard]] std::map<std::string, double> pass_seconds() const {
    std::map<std::string, double> sum = earlier_seconds_;
    for (const auto& [label, seconds] : context_.pass_seconds()) sum[label] += seconds;
    std::erase_if(sum,
                  [](const auto& pass) { return pass.second == 0; });  // passes of other pictures
    return sum;
  }

  /// Chooses the next round. Returns false if there is nothing left to trace.
  bool next_round(SamplePlan& plan, const TraceControl& control) {
    state_.round = {plan.is_adaptive() ? next_for_target(plan) : plan.least(control.order)};
    return !state_.round.is_done();
  }

  std::vector<SampleGroup> next_for_target(SamplePlan& plan) {
    std::vector<SampleGroup> groups = plan.pilot();
    if (!groups.empty()) return groups;
    const bool only_pilot = plan.only_pilot_has_samples();
    // Rounding makes errors depend on the order of samples; with a target the order is always the
    // same.
    if (!only_pilot && !(groups = plan.least()).empty()) return groups;
    const std::vector<std::uint32_t>& samples = plan.samples();
    const HostView sums = context_.view(film_.sums), squares = context_.view(film_.squares);
    const FilmMoments moments(sums, squares, layout_, options_, samples, width_);
    std::vector<std::vector<float>> variances = moments.variances();
    if (only_pilot) return plan.after_pilot(variances);
    groups = plan.next(variances);
    if (groups.empty()) variances_ = std::move(variances);
    return groups;
  }

  /// Traces the rest of the round. Returns false if it was stopped before its end.
  bool trace_round(const SamplePlan& plan, const TraceControl& control) {
    Round& round = state_.round;
    // With a target the rounds so far are only a part of the work.
    const double total = plan.is_adaptive() ? sum_of(plan.samples()) / plan.fraction_done()
                                            : static_cast<double>(layout_.pixels) * plan.minimum();
    for (bool new_group = true; !round.is_done(); new_group = round.entry + round.sample == 0) {
      if (!save_if_due(plan, control)) return false;
      if (control.stop && control.stop()) return false;
      const SampleGroup& group = round.groups[round.group];
      const SliceParams slice = next_slice(round, state_.slice_samples);
      if (backs_ && !backs_->fits(slice, group.work)) trace_backs();
      if (new_group)
        context_.write(queues_.work, group.work.data(), group.work.size() * sizeof(PixelWork));
      trace_slice(slice);
      is_saved_ = false;
      traced_ += static_cast<double>(samples_of(slice));
      advance(round, state_.slice_samples);
      progress_ = std::max(progress_, std::min(std::nextafter(1.0, 0.0), traced_ / total));
      if (control.progress) control.progress(progress_);
    }
    return true;
  }

  /// Returns false if the render is to stop: then it is saved at its end.
  bool save_if_due(const SamplePlan& plan, const TraceControl& control) {
    if (!control.save || traced_ <= saved_samples_ ||
        Clock::now() - saved_ < std::chrono::duration<double>(control.save_every))
      return true;
    if (control.stop && control.stop()) return false;
    if (control.progress) control.progress(progress_);  // no slice follows
    trace_backs();
    read_state(plan);
    control.save(state_);
    release_sums();
    saved_ = Clock::now();
    saved_samples_ = traced_;
    is_saved_ = true;
    return true;
  }

  /// At the end: `finished` unless interrupted.
  void keep_state(const SamplePlan& plan, const TraceControl& control, bool finished) {
    if (!control.save && !control.finish) return;
    read_state(plan);
    if (control.save && !is_saved_) control.save(state_);
    if (control.finish && finished) control.finish(state_);
    release_sums();
  }

  std::vector<std::vector<float>> standard_errors(const std::vector<std::uint32_t>& samples) {
    std::vector<std::vector<float>> errors = std::move(variances_);
    if (errors.empty()) {
      const HostView sums = context_.view(film_.sums), squares = context_.view(film_.squares);
      errors = FilmMoments(sums, squares, layout_, options_, samples, width_).variances();
    }
    for (std::vector<float>& pass : errors)
      tbb::parallel_for(std::size_t{0}, pass.size(), [&](std::size_t p) {
        pass[p] = std::sqrt(pass[p] * DAPPLE_SAMPLE_BATCH / static_cast<float>(samples[p]));
      });
    return errors;
  }

  [[nodiscard]] std::span<const PixelWork> work_of_round() const {
    return state_.round.groups[state_.round.group].work;
  }

  void trace_slice(const SliceParams& slice) {
    camera_.slice = slice;
    resolve_.slice = slice;
    camera_pass(context_, scene_, queues_, camera_);
    if (bias_) bias_->choose(slice, work_of_round());
    if (looks_up_hits_) add_hits(slice);
    resolve_.plane = 0;
    resolve_.scale = layout_.unit_scale;
    resolve_surface_pass(context_, queues_, film_, resolve_);
    if (backs_) backs_->add(slice, work_of_round());
    if (layout_.shading()) {
      resolve_.plane = layout_.shading();
      shading_pass(context_, scene_, queues_, film_, resolve_, rays_.viewpoint(),
                   footprint_samples(options_));
    }
    const std::uint32_t hits = compact_pass(context_, queues_, samples_of(slice));
    if (hits == 0) return;
    if (bias_) bias_->keep_hits(queues_);
    trace_side({queues_}, hits);
  }

  /// The pending ones, if there are any.
  void trace_backs() {
    if (!backs_ || backs_->empty()) return;
    const Queues& queues = backs_->queues();
    if (bias_) bias_->choose_backs(backs_->choice(), backs_->work());
    count_backs_pass(context_, queues, film_, backs_->choice());
    resolve_.slice = packed_slice(backs_->choice());
    backs_->clear();
    const std::size_t samples = samples_of(resolve_.slice);
    if (layout_.normals) move_points_pass(context_, scene_, queues, rays_.viewpoint(), samples);
    const std::uint32_t hits = compact_pass(context_, queues, samples);
    if (hits == 0) return;
    if (bias_) bias_->keep_hits(queues);
    trace_side({queues, true}, hits);
  }

  void add_hits(const SliceParams& slice) {
    const HostView points = context_.view(queues_.points);
    const HostView hits = context_.view(queues_.sample_hits);
    hit_sums_.add(slice, work_of_round(), points.values<SurfacePoint>(), hits.values<SampleHits>(),
                  resolve_);
  }

  /// The points of one side of the surfaces.
  struct Side {
    const Queues& queues;
    bool is_back = false;
  };

  void trace_side(const Side& side, std::uint32_t hits) {
    resolve_.backs = side.is_back ? 1 : 0;
    resolve_.albedo = layout_.albedo && !side.is_back ? 1 : 0;
    if (options_.ao) trace_ao(side, hits);
    for (uint light = 0; light < light_count_; ++light)
      if (!scene_.dark_lights[light]) trace_light(side, light, hits);
  }

  void trace_ao(const Side& side, std::uint32_t hits) {
    const OcclusionParams params = rays_.make_ao(side.queues, hits);
    occlusion_pass(context_, side.queues, scene_, "ao occlusion", options_.estimator, params,
                   RayOrder::by_pixel);
    if (bias_) bias_->collect(first_layer(side), side.queues, params);
    resolve_.plane = side.is_back ? layout_.back_ao : layout_.ao;
    resolve_.visits = layout_.ao_visits();
    resolve_.squares = 0;
    resolve_.rays = params.rays_per_point;
    resolve_.scale = layout_.unit_scale;
    resolve_ao_pass(context_, side.queues, film_, resolve_);
  }

  void trace_light(const Side& side, uint light, std::uint32_t hits) {
    const OcclusionParams params = rays_.make_light(side.queues, light, hits);
    occlusion_pass(context_, side.queues, scene_, "light occlusion", options_.estimator, params,
                   RayOrder::by_pixel);
    if (bias_)
      bias_->collect(first_layer(side) + (options_.ao ? 1 : 0) + light, side.queues, params);
    resolve_.plane = side.is_back ? layout_.back_lights[light] : layout_.lights[light].first;
    resolve_.visits = layout_.lights[light].visits();
    resolve_.squares = layout_.light_squares(light);
    resolve_.rays = params.rays_per_point;
    resolve_.scale = layout_.lights[light].scale;
    if (layout_.lights[light].channels == 3)
      resolve_dome_pass(context_, scene_, side.queues, film_, resolve_, light);
    else
      resolve_light_pass(context_, side.queues, film_, resolve_);
  }

  /// In the order of BiasSums.
  [[nodiscard]] std::size_t first_layer(const Side& side) const {
    return side.is_back ? layer_count() / 2 : 0;
  }

  DeviceContext& context_;
  const DeviceBuffers& scene_;
  const RenderOptions& options_;
  const FilmLayout& layout_;
  PictureRays rays_;
  std::size_t light_count_;
  int width_;  ///< pixels of the crop
  CameraParams camera_;
  ResolveParams resolve_{};
  Queues queues_;
  std::optional<BackSlices> backs_;  ///< if the backs are traced
  FilmBuffers film_;
  std::optional<BiasTracer> bias_;             ///< if a bias is reported
  std::vector<std::vector<float>> variances_;  ///< of the finished film, if known
  TraceState state_;  ///< without sums and squares while these are on the device
  bool looks_up_hits_;
  HitSums hit_sums_;
  double traced_ = 0;         ///< number of samples of all pixels
  double saved_samples_ = 0;  ///< of them in the last checkpoint
  bool is_saved_ = false;     ///< the last checkpoint has all samples
  double progress_ = 0;       ///< [0,1], estimated; never decreases
  std::map<std::string, double> earlier_seconds_;
  Clock::time_point saved_ = Clock::now();
};

}  // namespace

TracedPicture trace_picture(const Device& device, const DeviceScene& scene, const View& view,
                            const RenderOptions& options, const FilmLayout& layout,
                            const TraceControl& control, TraceState state,
                            const HitLookups& lookups) {
  return PictureTracer(device, scene, view, options, layout, std::move(state), lookups)
      .trace(view, control);
}

}  // namespace dapple
