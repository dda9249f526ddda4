#include "commands/bake/file_values.hpp"

#include <Imath/ImathVec.h>

#include <algorithm>

namespace dapple {
namespace {

/// A mesh of the scene that shows a primitive.
struct Use {
  const VertexSource* source;
  const BakedMesh* baked;
  double weight;  ///< the number of its placements
};

/// Means over the placements of a primitive, one for each vertex that it uses.
class PrimitiveValues {
 public:
  explicit PrimitiveValues(const std::vector<Use>& uses) : source_(*uses.front().source) {
    using Imath::V3d;
    const BakedMesh& like = *uses.front().baked;
    put_means<double>(
        uses, [](const BakedMesh& baked) -> auto& { return baked.ao; }, ao_);
    if (!like.bent.empty())
      put_means<V3d>(
          uses, [](const BakedMesh& baked) -> auto& { return baked.bent; }, bent_);
    light_.resize(like.light.size());
    for (std::size_t l = 0; l < light_.size(); ++l)
      put_means<V3d>(
          uses, [l](const BakedMesh& baked) -> auto& { return baked.light[l]; }, light_[l]);
  }

  /// Whether `set` has the same values where it has some.
  [[nodiscard]] bool agrees_with(const VertexValues& set) const {
    for (std::uint32_t i = 0; i < source_.count; ++i) {
      const std::uint32_t at = vertex(i);
      if (!set.taken[at]) continue;
      if (set.ao[at] != ao_[i] || (!bent_.empty() && set.bent[at] != bent_[i])) return false;
      for (std::size_t l = 0; l < light_.size(); ++l)
        if (set.light[l][at] != light_[l][i]) return false;
    }
    return true;
  }

  /// Without values, of `count` vertices.
  [[nodiscard]] VertexValues empty_set(std::size_t count) const {
    VertexValues set;
    set.ao.resize(count, 1.0f);
    if (!bent_.empty()) set.bent.resize(count, V3f(0, 0, 0));
    set.light.assign(light_.size(), std::vector<V3f>(count, V3f(0, 0, 0)));
    set.taken.resize(count);
    return set;
  }

  void put_into(VertexValues& set) const {
    for (std::uint32_t i = 0; i < source_.count; ++i) {
      const std::uint32_t at = vertex(i);
      set.taken[at] = true;
      set.ao[at] = ao_[i];
      if (!bent_.empty()) set.bent[at] = bent_[i];
      for (std::size_t l = 0; l < light_.size(); ++l) set.light[l][at] = light_[l][i];
    }
  }

 private:
  [[nodiscard]] std::uint32_t vertex(std::uint32_t i) const {
    return source_.used.empty() ? i : source_.used[i];
  }

  /// Equal values have themselves as their mean, to the bit.
  template <class Sum, class Value, class ValuesOf>
  void put_means(const std::vector<Use>& uses, const ValuesOf& values_of,
                 std::vector<Value>& means) const {
    double weights = 0;
    for (const Use& use : uses) weights += use.weight;
    for (std::uint32_t i = 0; i < source_.count; ++i) {
      Sum sum(0);
      for (const Use& use : uses)
        sum += Sum(values_of(*use.baked)[use.source->first + i]) * use.weight;
      means.push_back(Value(sum / weights));
    }
  }

  const VertexSource& source_;
  std::vector<float> ao_;
  std::vector<V3f> bent_;
  std::vector<std::vector<V3f>> light_;
};

}  // namespace

FileValues file_values(const gltf::SourceFile& file, const Scene& scene,
                       const std::vector<BakedMesh>& meshes,
                       const std::vector<std::size_t>& placements, const std::string& attribute) {
  std::map<FilePrimitive, std::vector<Use>> uses;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (meshes[m].ao.empty()) continue;
    for (const VertexSource& source : scene.meshes[m].sources)
      uses[{source.mesh, source.primitive}].push_back(
          {&source, &meshes[m], static_cast<double>(std::max<std::size_t>(1, placements[m]))});
  }
  FileValues result;
  for (const auto& [primitive, of_primitive] : uses) {
    const auto& [mesh, number] = primitive;
    const gltf::VertexKey key = file.vertex_key(mesh, number, attribute);
    const PrimitiveValues values(of_primitive);
    std::vector<VertexValues>& sets = result.sets[key];
    const auto set = std::find_if(sets.begin(), sets.end(), [&](const VertexValues& other) {
      return values.agrees_with(other);
    });
    result.primitives[primitive] = {key, static_cast<std::size_t>(set - sets.begin())};
    if (set == sets.end()) sets.push_back(values.empty_set(file.vertex_count(mesh, number)));
    values.put_into(sets[result.primitives[primitive].second]);
  }
  return result;
}

}  // namespace dapple
