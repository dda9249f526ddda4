// Resuming and checkpointing a render. In: options and the state of an earlier run; out: the state
// to continue from, checkpoints written on the way, notes for the user.
#pragma once

#include "render/checkpoint.hpp"
#include "render/picture.hpp"

namespace dapple {

/// The checkpoint `path`, and in `options` the footprints of its beginning. Throws Error failed
/// when it is damaged, Error usage when `options` differ from those that it was made with.
Checkpoint resume(const std::string& path, const View& view, RenderOptions& options);

/// Throws Error unless `resumed`, read from `path`, is of the very picture that is `now` to be
/// traced; adds to `notes` where it comes from.
void check_resumed(const std::string& path, const Checkpoint& resumed, const Checkpoint& now,
                   const FilmLayout& layout, std::vector<std::string>& notes);

/// Lets `tracing` write checkpoints as `control` asks, with all of `about` but its state. A failure
/// is kept in `result` for the end: a full disk must not cost what is traced.
void write_checkpoints(TraceControl& tracing, const RenderControl& control, Checkpoint about,
                       RenderResult& result);

/// How far it came, and how to go on.
std::string interruption_note(const TracedPicture& picture, const RenderOptions& options,
                              const RenderControl& control);

}  // namespace dapple
