// From what was found at samples to values at vertices. In: AO and bent normals of samples, both
// sides. Out: one value for each vertex, and how many more samples it needs.
#pragma once

#include <vector>

#include "bake/sample_tracer.hpp"
#include "dapple/bake.hpp"

namespace dapple {

class VertexValues {
 public:
  VertexValues(const Mesh& mesh, const VertexGroups& groups, BakeSides sides);

  /// Adds what one sample found on the sides that were traced.
  void add(const SurfaceSample& sample, const SideValue& front, const SideValue& back);

  /// Chooses the brighter side of each small part, such as a leaf, and of each vertex of larger
  /// ones, from the samples so far. `surely`: only where the difference is significant. Sides that
  /// were not chosen from, and all sides for BakeSides::mean, count both.
  void choose_sides(bool surely);

  /// Whether a side of a vertex group counts for its value.
  [[nodiscard]] bool counts(std::uint32_t group, bool back) const {
    return chosen_[group] == Chosen::both || (chosen_[group] == Chosen::back) == back;
  }

  /// The squared standard error of each group's AO, estimated from the samples around it and around
  /// vertices of similar AO.
  [[nodiscard]] std::vector<float> squared_errors() const;

  /// For each group, by what factor the number of its samples must grow for a standard error of
  /// `target`; 1: enough. Groups that may be hidden need more than others.
  [[nodiscard]] std::vector<float> missing_samples(float target) const;

  /// The values of all vertices. Vertices that see nothing at all lie inside closed geometry: they
  /// get the mean of their neighbours' values, and `hidden` is raised by their number. A mesh part
  /// that is hidden as a whole has AO 0.
  [[nodiscard]] BakedMesh finish(bool bent, std::size_t& hidden) const;

 private:
  /// Sums over the samples of one side.
  struct Side {
    float weight = 0, weight_squares = 0, ao = 0, ao_squares = 0;
    V3f bent{0, 0, 0};
    void add(float w, const SideValue& value);
    [[nodiscard]] float mean() const { return weight > 0 ? ao / weight : 0; }
    /// Number of samples of equal weight that would have the same standard error.
    [[nodiscard]] float count() const;
    /// Sum of squared deviations, for count() - 1 degrees of freedom.
    [[nodiscard]] float squared_deviations() const;
  };
  struct Group {
    Side front, back;
  };
  struct Value {
    float ao = 0;
    V3f bent{0, 0, 0};
    bool known = false;
  };
  enum class Chosen : std::uint8_t { both, front, back };
  class PooledVariance;

  [[nodiscard]] PooledVariance pooled_variance() const;

  [[nodiscard]] std::vector<Value> known_values() const;
  void spread_to_hidden(std::vector<Value>& values) const;

  const Mesh& mesh_;
  const VertexGroups& groups_;
  BakeSides sides_;
  std::vector<Group> of_group_;
  std::vector<std::uint32_t> part_;  ///< of each group; kLarge: of a part that is not small
  std::vector<Group> of_part_;
  std::vector<Chosen> chosen_;  ///< by group
};

}  // namespace dapple
