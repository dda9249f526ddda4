#include "render/partial/merged_sums.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "film/sums/wrapped_sum.hpp"

namespace dapple {
namespace {

[[noreturn]] void refuse(const std::string& path, const char* what) {
  throw Error(ErrorKind::failed, path + ": damaged: its " + what + " are not what it says");
}

/// Pixels of a picture that those of a part are added to.
class Window {
 public:
  Window(const PixelRect& part, const PixelRect& whole)
      : width_(static_cast<std::size_t>(part.width())),
        whole_width_(static_cast<std::size_t>(whole.width())),
        first_(static_cast<std::size_t>(part.y0 - whole.y0) * whole_width_ +
               static_cast<std::size_t>(part.x0 - whole.x0)) {}
  /// The number that a pixel of the part has in the whole picture.
  [[nodiscard]] std::size_t operator()(std::size_t pixel) const {
    return first_ + pixel / width_ * whole_width_ + pixel % width_;
  }

 private:
  std::size_t width_, whole_width_, first_;
};

/// Whether every pixel has as many samples as the pieces say.
bool have_samples(const Checkpoint& part) {
  const PixelRect& crop = part.picture.crop;
  const std::uint32_t splitting = splitting_factor(part.picture.options);
  std::vector<std::uint32_t> left = part.state.samples;
  for (const Piece& piece : part.pieces) {
    const std::uint32_t samples = (piece.rays.end - piece.rays.first) * splitting;
    for (int y = piece.rect.y0; y <= piece.rect.y1; ++y) {
      for (int x = piece.rect.x0; x <= piece.rect.x1; ++x) {
        std::uint32_t& has =
            left[static_cast<std::size_t>(y - crop.y0) * static_cast<std::size_t>(crop.width()) +
                 static_cast<std::size_t>(x - crop.x0)];
        if (has < samples) return false;
        has -= samples;
      }
    }
  }
  return std::all_of(left.begin(), left.end(), [](std::uint32_t count) { return count == 0; });
}

void check(const std::string& path, const Checkpoint& part) {
  const PictureRecord& picture = part.picture;
  check_state(path, part.state, shape_of(picture.layout(), picture.options, picture.names));
  if (!have_samples(part)) refuse(path, "samples");
  const bool one = part.pieces.size() == 1;
  if (one &&
      part.state.first_sample != part.pieces[0].rays.first * splitting_factor(picture.options))
    refuse(path, "first samples");
}

}  // namespace

MergedSums::MergedSums(const PictureRecord& picture)
    : record_(picture),
      layout_(picture.layout()),
      mattes_(picture.options.cryptomattes.any() ? layout_.pixels : 0, kAnyMatteSlots) {
  state_.sums.resize(std::size_t{layout_.pixels} * layout_.plane_count);
  state_.samples.resize(layout_.pixels);
  if (picture.options.motion) state_.motion = MotionSums(layout_.pixels);
}

void MergedSums::add(const std::string& path, Checkpoint part) {
  check(path, part);
  const TraceState& state = part.state;
  const std::size_t pixels = state.samples.size(), whole = layout_.pixels;
  const Window at(part.picture.crop, record_.crop);
  tbb::parallel_for(0u, layout_.plane_count, [&](std::uint32_t plane) {
    for (std::size_t p = 0; p < pixels; ++p) {
      std::int64_t& sum = state_.sums[plane * whole + at(p)];
      sum = saturated_sum(sum, state.sums[plane * pixels + p]);
    }
  });
  for (std::size_t p = 0; p < pixels; ++p) state_.samples[at(p)] += state.samples[p];
  for (std::size_t p = 0; p < state.motion.values().size(); ++p)
    state_.motion.add(at(p), state.motion.values()[p]);
  if (mattes_.pixel_count() > 0) {
    MatteSums mattes;
    mattes.unpack(state.mattes, pixels);
    for (std::size_t p = 0; p < pixels; ++p) mattes_.add(at(p), mattes.of_pixel(p));
  }
  for (const auto& [label, seconds] : state.pass_seconds) state_.pass_seconds[label] += seconds;
  state_.slice_samples = std::max(state_.slice_samples, state.slice_samples);
}

void MergedSums::write(const std::string& path, const Checkpoint& about) {
  const bool one = about.pieces.size() == 1;
  const std::uint32_t first = one ? about.pieces[0].rays.first : 0;
  state_.first_sample = first * splitting_factor(record_.options);
  if (mattes_.pixel_count() > 0) {
    MatteSums mattes = mattes_;
    // No earlier samples can come: what is beyond the picture's slots is not needed.
    if (one && first == 0) mattes.keep_first();
    state_.mattes = mattes.packed();
  }
  write_checkpoint(path, about, state_, Durable::yes);
  state_.mattes = {};
}

TracedPicture MergedSums::picture() && {
  TracedPicture picture;
  const auto sums = std::make_shared<std::vector<std::int64_t>>(std::move(state_.sums));
  picture.sums = HostView(sums, std::as_bytes(std::span(*sums)));
  picture.samples = std::move(state_.samples);
  picture.mattes = std::move(mattes_);
  picture.motion = std::move(state_.motion);
  picture.pass_seconds = std::move(state_.pass_seconds);
  return picture;
}

}  // namespace dapple
