#include "render/partial/resume.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "render/stopwatch.hpp"
#include "sampling/sample_plan.hpp"
#include "sampling/shard.hpp"

namespace dapple {
namespace {

/// The number of samples may be larger than that of the checkpoint, but not smaller.
void require_enough_samples(const std::string& path, const TraceState& state,
                            const RenderOptions& options) {
  const bool adaptive = is_adaptive(options);
  const int asked = adaptive ? options.max_spp : options.spp;
  const auto splitting = static_cast<std::uint32_t>(splitting_factor(options));
  const auto most =
      state.samples.empty() ? 0u : *std::max_element(state.samples.begin(), state.samples.end());
  const std::uint32_t least = adaptive ? least_samples(by_sample(options).spp) : 0;
  if (most <= std::max(least, static_cast<std::uint32_t>(asked) * splitting)) return;
  throw Error(ErrorKind::usage,
              fmt::format("--resume {}: has {} samples per pixel already, {} {} is fewer", path,
                          most / splitting, adaptive ? "--max-spp" : "--spp", asked));
}

/// A render goes on from its first sample up to some other, in all pixels.
void require_one_piece(const std::string& path, const Checkpoint& checkpoint,
                       const RenderOptions& options) {
  const std::uint32_t first = rays_of(options.shard, options.spp).first;
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorKind::usage, fmt::format("--resume {}: {}", path, why));
  };
  if (checkpoint.pieces.size() > 1) {
    refuse(fmt::format("is not whole, it lacks {}; dapple merge adds the missing parts",
                       missing_text(checkpoint.pieces, checkpoint.picture.metadata.samples)));
  }
  if (checkpoint.state.first_sample != first * splitting_factor(options))
    refuse("begins with another sample; dapple merge adds the parts before it");
}

}  // namespace

Checkpoint resume(const std::string& path, const Settings& asked, RenderOptions& options,
                  std::vector<std::string>& notes) {
  Checkpoint checkpoint = read_checkpoint(path);
  if (checkpoint.pieces.size() > 1) require_one_piece(path, checkpoint, options);
  require_same(path, checkpoint.options, asked);
  require_one_piece(path, checkpoint, options);
  require_enough_samples(path, checkpoint.state, options);
  if (options.footprint_spp > 0 && options.footprint_spp != checkpoint.footprint_spp) {
    throw Error(ErrorKind::usage,
                fmt::format("--resume {}: was made with footprint_spp {}, this run has {}", path,
                            checkpoint.footprint_spp, options.footprint_spp));
  }
  options.footprint_spp = checkpoint.footprint_spp;
  // --max-bias 0 asks for --footprint, but is the same setting as none, which may choose a smaller
  // one.
  if (options.max_bias == 0.0f && options.footprint != checkpoint.footprint)
    notes.push_back(fmt::format("{} goes on with the footprint that it began with, {:g}, not {:g}",
                                path, checkpoint.footprint, options.footprint));
  options.footprint = checkpoint.footprint;
  return checkpoint;
}

void check_resumed(const std::string& path, const Checkpoint& resumed, const Checkpoint& now,
                   const FilmLayout& layout, const RenderOptions& options,
                   std::vector<std::string>& notes) {
  require_same(path, resumed.content, now.content);
  check_state("--resume " + path, resumed.state, shape_of(layout, options, now.picture.names));
  notes.push_back("went on from " + path);
  if (resumed.device != now.device) {
    notes.push_back(
        fmt::format("{} was traced on {}: the picture's bits are not those of one device", path,
                    resumed.device));
  }
}

void write_checkpoints(TraceControl& tracing, const RenderControl& control, Checkpoint about,
                       RenderResult& result) {
  if (!control.part.empty()) {
    tracing.finish = [&control, about](const TraceState& state) {
      write_checkpoint(control.part, about, state, Durable::yes);
    };
  }
  if (control.checkpoint.empty()) return;
  tracing.order = SampleOrder::sweeps;
  tracing.save_every = control.checkpoint_every;
  auto stopped = std::make_shared<bool>(false);
  if (control.stop) tracing.stop = [&control, stopped] { return *stopped = control.stop(); };
  tracing.skip_film = [&control, &result] {
    return result.checkpoint_failure.empty() && control.skip_film && control.skip_film();
  };
  tracing.save = [&control, &result, stopped, about = std::move(about)](const TraceState& state) {
    const Stopwatch writing;
    const bool failed_before = !result.checkpoint_failure.empty();
    result.checkpoint_failure.clear();
    try {
      write_checkpoint(control.checkpoint, about, state, Durable::no,
                       *stopped ? CompressionLevel::fastest : CompressionLevel::standard);
    } catch (const Error& error) {
      result.checkpoint_failure = error.what();
      if (control.warn && !failed_before && !*stopped) control.warn(result.checkpoint_failure);
    }
    result.statistics.seconds.checkpoint += writing.seconds();
  };
}

std::string interruption_note(const TracedPicture& picture, const RenderOptions& options,
                              const RenderControl& control) {
  const double samples = std::accumulate(picture.samples.begin(), picture.samples.end(), 0.0) /
                         static_cast<double>(picture.samples.size() * splitting_factor(options));
  const std::string part =
      control.part.empty() ? "" : control.part + " is not written, it would lack samples; ";
  const std::string next =
      control.checkpoint.empty()
          ? "with --checkpoint F an image without --frames, --shutter and --deep goes on"
          : "--resume " + control.checkpoint + " goes on";
  return fmt::format("interrupted after {:.3g} samples a pixel on average; {}{}", samples, part,
                     next);
}

}  // namespace dapple
