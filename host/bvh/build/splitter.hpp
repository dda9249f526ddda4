// Splits ranges of primitives in two, top-down, by the surface area heuristic, and decides which
// ranges become leaves.
#pragma once

#include <span>

#include "bvh/build/binning.hpp"

namespace dapple {

/// A range of primitives with its bounds.
struct Part {
  Box8 box, centres2;
  std::uint32_t first = 0, count = 0;
  float area = 0;           ///< half_area() of the box
  int depth = 0;            ///< splits above
  unsigned left_set = 0;    ///< for few primitives: bit i is set if primitive i goes left
  bool leaf = false;        ///< one primitive, or not more expensive than two leaves
  bool in_scratch = false;  ///< whether its primitives are in the scratch array
};

/// Splits by the surface area heuristic. The result does not depend on threads.
class Splitter {
 public:
  /// Reorders `result`; `scratch`, of the same size, is scratch memory. Both must outlive the
  /// object.
  Splitter(std::span<PrimitiveBox> result, std::span<PrimitiveBox> scratch, std::uint32_t leaf_size)
      : result_(result.data()),
        scratch_(scratch.data()),
        count_(static_cast<std::uint32_t>(result.size())),
        leaf_size_(leaf_size) {}

  [[nodiscard]] Part all() const;

  /// Splits `part`, which must not be a leaf: it becomes the left side. Large parts are split in
  /// parallel.
  void split(Part& part, Part& right) const;

  /// The array that holds all primitives at the end. move_to_result() copies the primitives of a
  /// part to it.
  [[nodiscard]] std::span<PrimitiveBox> result() const { return {result_, count_}; }
  void move_to_result(Part& part) const;

 private:
  void split_few(Part& part, Part& right) const;
  void split_in_parallel(Part& part, Part& right) const;
  void halve(Part& part, Part& right) const;
  /// Sets area, leaf and left_set.
  void evaluate_leaf(Part& part) const;
  [[nodiscard]] PrimitiveBox* at(const Part& part) const {
    return (part.in_scratch ? scratch_ : result_) + part.first;
  }

  PrimitiveBox *result_, *scratch_;
  std::uint32_t count_, leaf_size_;
};

}  // namespace dapple
