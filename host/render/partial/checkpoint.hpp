// A render's state as a file: its settings and what was traced so far, sealed with a checksum.
// Files of shards and of merges are the same, with all of their samples traced.
#pragma once

#include <string>
#include <vector>

#include "files/compression.hpp"
#include "files/output_file.hpp"
#include "render/partial/picture_record.hpp"
#include "render/partial/pieces.hpp"
#include "render/render_settings.hpp"
#include "render/trace_state.hpp"

namespace dapple {

struct Checkpoint {
  Settings options, content;  ///< option_settings(), content_settings()
  int footprint_spp = 1;      ///< samples that its footprints are computed for
  float footprint = 0;        ///< scale that was used; the options may have demanded a bias
  std::string device;         ///< name of the device that traced last
  PictureRecord picture = {};
  /// The samples that the file has. Empty: a single piece, once all samples are traced; a file that
  /// was read then is not finished.
  std::vector<Piece> pieces = {};
  TraceState state = {};
};

/// The content of the file. The state is separate so that it need not be copied.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint,
                      const TraceState& state, Durable durable = Durable::no,
                      CompressionLevel level = CompressionLevel::standard);

/// Reads and verifies the file. Throws Error failed, "--resume PATH: ...", if it is damaged.
/// Whether the state fits a picture is checked by check_state().
Checkpoint read_checkpoint(const std::string& path);

/// What is read of a file to merge: all but its state, or all.
enum class PartContents : bool { description, all };

/// The same for such a file. Errors are "PATH: ...".
Checkpoint read_part(const std::string& path, PartContents contents);

/// The size that a state must have: pixels and planes of the picture; for Cryptomattes the numbers
/// of objects and materials, else 0.
struct StateShape {
  std::size_t pixels = 0, sums = 0, squares = 0, objects = 0, materials = 0;
  bool motion = false;
};

/// The shape of the states of a picture.
StateShape shape_of(const FilmLayout& layout, const RenderOptions& options,
                    const MatteNames& names);

/// Throws Error failed, "NAME: ...", unless every index and size in `state` is within `shape`.
void check_state(const std::string& name, const TraceState& state, const StateShape& shape);

}  // namespace dapple
