// Edits a copy of a glTF file: its JSON is changed in place, and new bytes come at the end of one
// of its buffers, so that all else stays as it is, unknown extensions included. From a .glb what
// lost its last use by that is dropped.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "files/output_file.hpp"
#include "scene/gltf/edit/source_content.hpp"

namespace dapple::gltf {

class Editor {
 public:
  /// `out`: the file to write, .glb or .gltf by its name. A .glb gets the buffers and images that
  /// the file keeps beside it.
  Editor(const SourceFile& source, std::string out);

  [[nodiscard]] Json& json() { return json_; }
  [[nodiscard]] const SourceFile::Content& content() const { return *source_.content; }

  /// Adds an entry to an array of the document. Returns its index.
  std::size_t push(const char* array, Json entry);
  /// Adds a bufferView with these bytes. `stride` and `target` 0: none. Returns its index.
  std::size_t add_view(const std::string& bytes, std::size_t stride = 0, int target = 0);
  /// Adds an image: in the buffer of a .glb, in the file image_path(suffix) beside a .gltf.
  std::size_t add_image(const std::string& png, const std::string& suffix);

  /// Adds `out` to `files`. Data of a .gltf go to a file beside it. Files that the source names are
  /// copied there at once, one after the other, unless they are there already (side_copies()).
  void write(PendingFiles& files);

  /// Bytes of chunks of a GLB that `out` cannot have: those of other types than JSON and BIN.
  [[nodiscard]] std::size_t lost_bytes() const;

  /// NAME`suffix`.png beside `out`, or with a number if the source has an image of that name.
  [[nodiscard]] std::string image_path(const std::string& suffix) const;

  /// Files that write() copies beside the output: from where to where. None that are in place.
  /// Beside a .glb, which has its buffers and images, those that extensions name.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> side_copies() const;

  /// Other files that write() may write, without images of add_image().
  [[nodiscard]] std::vector<std::string> new_side_files() const;

 private:
  [[nodiscard]] bool is_glb_out() const;
  /// Whether a buffer is the binary chunk of a GLB file. The chunk is unused if buffer 0 has a uri.
  [[nodiscard]] bool has_binary() const;
  [[nodiscard]] bool has_no_buffer_files() const;
  [[nodiscard]] std::string side_name() const;
  [[nodiscard]] std::string free_name(const std::string& suffix,
                                      const std::string& extension) const;
  void start_from_binary();
  void embed_buffers();
  void embed_images();
  void remove_buffer();
  void copy_side_files() const;

  const SourceFile& source_;
  std::string out_;
  Json json_;
  std::string bytes_;
  std::size_t buffer_ = 0;
  std::vector<std::pair<std::string, std::string>> new_images_;  ///< path, bytes
};

inline constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;

}  // namespace dapple::gltf
