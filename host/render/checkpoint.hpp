// A render's state as a file: what it was made with and how far it is, sealed with a checksum.
#pragma once

#include <string>

#include "render/render_settings.hpp"
#include "render/trace_state.hpp"

namespace dapple {

struct Checkpoint {
  Settings options, content;  ///< option_settings(), content_settings()
  int footprint_spp = 1;      ///< samples that its footprints are made for
  std::string device;         ///< that traced it last
  TraceState state = {};
};

/// What the file is beside the state; `state` apart, so that it need not be copied.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint,
                      const TraceState& state);

/// Whole and unharmed, or Error failed, "--resume PATH: ..." with what is wrong. That the state
/// fits a picture is for check_state() to tell.
Checkpoint read_checkpoint(const std::string& path);

/// What a state has to fit: pixels of the picture and its planes.
struct StateShape {
  std::size_t pixels = 0, sums = 0, squares = 0;
};

/// Throws Error failed unless every index and size in `state` is within `shape`.
void check_state(const std::string& path, const TraceState& state, const StateShape& shape);

}  // namespace dapple
