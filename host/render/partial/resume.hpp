// Resuming and checkpointing a render. In: options and the state of an earlier run; out: the state
// to continue from, checkpoints written on the way, notes for the user.
#pragma once

#include "film/cryptomatte.hpp"
#include "render/partial/checkpoint.hpp"
#include "render/picture.hpp"

namespace dapple {

/// Reads the checkpoint `path` and sets the footprints in `options`, whose option_settings() are
/// `asked`, to those of the first run. Throws Error failed if it is damaged, Error usage if
/// `options` differ from those of the checkpoint. A note says if the footprint is not what was
/// asked for.
Checkpoint resume(const std::string& path, const Settings& asked, RenderOptions& options,
                  std::vector<std::string>& notes);

/// Throws Error unless `resumed`, read from `path`, belongs to the picture that `now` describes.
/// Adds a note about its origin to `notes`.
void check_resumed(const std::string& path, const Checkpoint& resumed, const Checkpoint& now,
                   const FilmLayout& layout, const RenderOptions& options,
                   std::vector<std::string>& notes);

/// Makes `tracing` write checkpoints and the part as `control` asks, with the settings of `about`.
/// A failure of a checkpoint is stored in `result` until the end, so that a full disk does not lose
/// the picture.
void write_checkpoints(TraceControl& tracing, const RenderControl& control, Checkpoint about,
                       RenderResult& result);

/// A note that says how much was traced and how to continue.
std::string interruption_note(const TracedPicture& picture, const RenderOptions& options,
                              const RenderControl& control);

}  // namespace dapple
