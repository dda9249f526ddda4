// The sum of parts of a picture. In: parts, one after the other. Out: what a render would have
// traced, or a file of it. Sums are whole numbers, so their order does not matter.
#pragma once

#include "film/traced_picture.hpp"
#include "render/partial/checkpoint.hpp"

namespace dapple {

class MergedSums {
 public:
  /// For all pixels of the picture's crop.
  explicit MergedSums(const PictureRecord& picture);

  /// Adds a part, read from `path`. Throws Error failed if its state is not what its description
  /// says.
  void add(const std::string& path, Checkpoint part);

  /// Writes the sums so far as a part with this description.
  void write(const std::string& path, const Checkpoint& about);

  /// The picture; takes the sums.
  TracedPicture picture() &&;

 private:
  PictureRecord record_;
  FilmLayout layout_;
  TraceState state_;
  MatteSums mattes_;
};

}  // namespace dapple
