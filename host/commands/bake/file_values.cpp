#include "commands/bake/file_values.hpp"

#include <algorithm>

namespace dapple {
namespace {

/// A mesh of the scene that shows a primitive.
struct Use {
  const VertexSource* source;
  const BakedMesh* baked;
};

/// Means over the uses of a primitive, one for each vertex that it uses.
class PrimitiveValues {
 public:
  explicit PrimitiveValues(const std::vector<Use>& uses) : source_(*uses.front().source) {
    const BakedMesh& like = *uses.front().baked;
    ao_.resize(source_.count);
    if (!like.bent.empty()) bent_.resize(source_.count, V3f(0, 0, 0));
    light_.assign(like.light.size(), std::vector<V3f>(source_.count, V3f(0, 0, 0)));
    for (const Use& use : uses) add(use);
    divide(static_cast<float>(uses.size()));
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

  void add(const Use& use) {
    for (std::uint32_t i = 0; i < source_.count; ++i) {
      const std::uint32_t from = use.source->first + i;
      ao_[i] += use.baked->ao[from];
      if (!bent_.empty()) bent_[i] += use.baked->bent[from];
      for (std::size_t l = 0; l < light_.size(); ++l) light_[l][i] += use.baked->light[l][from];
    }
  }

  /// Equal values have themselves as their mean, to the bit.
  void divide(float count) {
    for (float& value : ao_) value /= count;
    for (V3f& value : bent_) value /= count;
    for (std::vector<V3f>& of_light : light_)
      for (V3f& value : of_light) value /= count;
  }

  const VertexSource& source_;
  std::vector<float> ao_;
  std::vector<V3f> bent_;
  std::vector<std::vector<V3f>> light_;
};

}  // namespace

FileValues file_values(const gltf::SourceFile& file, const Scene& scene,
                       const std::vector<BakedMesh>& meshes, const std::string& attribute) {
  std::map<FilePrimitive, std::vector<Use>> uses;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (meshes[m].ao.empty()) continue;
    for (const VertexSource& source : scene.meshes[m].sources)
      uses[{source.mesh, source.primitive}].push_back({&source, &meshes[m]});
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
