// From what was found at samples to values at vertices. In: AO and bent normals of samples, both
// sides. Out: one value for each vertex.
#pragma once

#include <vector>

#include "bake/surface_samples.hpp"
#include "dapple/bake.hpp"

namespace dapple {

/// AO and the sum of unoccluded directions, in object space, seen from one side of a sample.
struct SideValue {
  float ao = 0;
  V3f bent{0, 0, 0};
};

class VertexValues {
 public:
  VertexValues(const Mesh& mesh, const VertexGroups& groups, BakeSides sides)
      : mesh_(mesh), groups_(groups), sides_(sides), of_group_(groups.count) {}

  /// Adds what one sample found. `back` counts for two-sided samples.
  void add(const SurfaceSample& sample, const SideValue& front, const SideValue& back);

  /// The values of all vertices. Vertices that see nothing at all lie inside closed geometry: they
  /// get the mean of their neighbours' values, and `hidden` is raised by their number. A mesh part
  /// that is hidden as a whole has AO 0.
  [[nodiscard]] BakedMesh finish(bool bent, std::size_t& hidden) const;

 private:
  struct Side {
    double weight = 0, ao = 0;
    Imath::V3d bent{0, 0, 0};
    void add(float w, const SideValue& value);
    [[nodiscard]] double mean() const { return weight > 0 ? ao / weight : 0; }
  };
  struct Group {
    Side front, back;
  };
  struct Value {
    float ao = 0;
    V3f bent{0, 0, 0};
    bool known = false;
  };

  [[nodiscard]] std::vector<bool> parts_that_show_their_back() const;
  [[nodiscard]] std::vector<Value> known_values() const;
  void spread_to_hidden(std::vector<Value>& values) const;

  const Mesh& mesh_;
  const VertexGroups& groups_;
  BakeSides sides_;
  std::vector<Group> of_group_;
};

}  // namespace dapple
