#include "bake/texture/texture_bake.hpp"

#include <algorithm>
#include <cmath>

#include "bake/texture/dilation.hpp"
#include "bake/texture/seams.hpp"
#include "bake/texture/texel_cover.hpp"
#include "bake/texture/uv_overlap.hpp"
#include "bake/vertex_bake.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

/// Barycentric coordinates of `p` in a triangle of the texture.
std::array<float, 3> barycentric(const V2f* uv, const V2f& p) {
  const V2f a = uv[1] - uv[0], b = uv[2] - uv[0], c = p - uv[0];
  const float area = a.cross(b);
  const float v = c.cross(b) / area, w = a.cross(c) / area;
  return {1 - v - w, v, w};
}

}  // namespace

/// The covered texels of one mesh.
class SampledTexels : public SampledSurface {
 public:
  SampledTexels(const Mesh& mesh, std::span<const V2f> corners, const std::vector<bool>& two_sided,
                const BakeOptions& options, std::uint32_t hash)
      : mesh_(mesh),
        corners_(corners),
        two_sided_(two_sided),
        normals_(options.normals),
        size_(options.texture_size),
        hash_(hash),
        cover_(cover_texels(corners, options.texture_size)) {}

  [[nodiscard]] std::size_t size() const override { return cover_.texel.size(); }
  [[nodiscard]] bool can_be_sampled(std::size_t) const override { return true; }
  [[nodiscard]] std::array<std::uint32_t, 3> places(std::size_t i) const override {
    const auto place = static_cast<std::uint32_t>(i);
    return {place, place, place};
  }
  [[nodiscard]] std::uint32_t texel(std::size_t i) const { return cover_.texel[i]; }
  [[nodiscard]] std::span<const std::uint32_t> triangles(std::size_t i) const {
    return std::span(cover_.triangles)
        .subspan(cover_.first[i], cover_.first[i + 1] - cover_.first[i]);
  }
  [[nodiscard]] TexelPolygon polygon(std::size_t i, std::uint32_t triangle) const {
    return clip_to_texel(&corners_[3 * triangle], size_, texel(i) % size_, texel(i) / size_);
  }

  // A point that is uniform over the parts of all triangles in the texel.
  [[nodiscard]] SurfaceSample sample(std::size_t i, std::uint32_t index,
                                     std::uint32_t sequence) const override {
    const auto [u, v] = spread_pair(index, hash_of(hash_ + sequence, texel(i)));
    double area = 0;
    for (const std::uint32_t t : triangles(i)) area += double{polygon(i, t).area()};
    double left = u * area;
    for (const std::uint32_t t : triangles(i)) {
      const TexelPolygon part = polygon(i, t);
      for (std::size_t k = 2; k < part.count; ++k) {
        const V2f* p = part.corners.data();
        const double fan = 0.5 * std::fabs(double{(p[k - 1] - p[0]).cross(p[k] - p[0])});
        const bool last = t == triangles(i).back() && k + 1 == part.count;
        if (left >= fan && !last) {
          left -= fan;
          continue;
        }
        const double s = std::sqrt(std::clamp(fan > 0 ? left / fan : 0.5, 0.0, 1.0));
        const auto a = static_cast<float>(1 - s), b = static_cast<float>(s * (1 - v));
        return sample_at(static_cast<std::uint32_t>(i), t,
                         p[0] * a + p[k - 1] * b + p[k] * (1 - a - b));
      }
    }
    return sample_at(static_cast<std::uint32_t>(i), triangles(i)[0],
                     polygon(i, triangles(i)[0]).corners[0]);
  }

 private:
  [[nodiscard]] SurfaceSample sample_at(std::uint32_t place, std::uint32_t t, const V2f& p) const {
    const auto weights = barycentric(&corners_[3 * t], p / static_cast<float>(size_));
    SurfaceSample sample;
    sample.normal = area_vector(mesh_, t).normalized();
    sample.back = two_sided_[t];
    sample.reach = reach_of(mesh_, t);
    sample.place[0] = place;
    sample.weight[0] = 1;
    for (std::size_t k = 0; k < 3; ++k)
      sample.position += mesh_.positions[mesh_.indices[3 * t + k]] * weights[k];
    if (normals_ == Normals::shading) add_shading(mesh_, t, weights, sample);
    return sample;
  }

  const Mesh& mesh_;
  std::span<const V2f> corners_;
  const std::vector<bool>& two_sided_;
  Normals normals_;
  std::uint32_t size_, hash_;
  TexelCover cover_;
};

namespace {

/// The small part of the mesh that a texel shows: that of its first triangle. Texels have the front
/// of their triangle, so sheets back to back are parts of their own.
SmallParts parts_of_texels(const Mesh& mesh, const SampledTexels& texels) {
  const VertexGroups groups = group_vertices(mesh);
  SmallParts parts = small_parts(mesh, groups);
  std::vector<std::uint32_t> of_texel(texels.size());
  for (std::size_t i = 0; i < of_texel.size(); ++i)
    of_texel[i] =
        parts.of_place[groups.of_vertex[mesh.indices[3 * std::size_t{texels.triangles(i)[0]}]]];
  parts.of_place = std::move(of_texel);
  return parts;
}

}  // namespace

TextureBake::TextureBake(const Scene& scene, const BakeOptions& options, TextureLayout layout)
    : scene_(scene), options_(options), two_sided_(scene, options.sides) {
  const std::size_t texels = std::size_t{options.texture_size} * options.texture_size;
  texture_.size = options.texture_size;
  texture_.layout = std::move(layout);
  texture_.ao.resize(texels);
  if (options.bent) texture_.bent.resize(texels, V3f(0));
  known_.resize(texels);
  covered_.resize(texels);
  weight_.resize(texels);
}

bool TextureBake::add(std::uint32_t index, const Placements& placements, BakeTracing& tracing) {
  const Mesh& mesh = scene_.meshes[index];
  const std::vector<bool> two_sided = two_sided_.triangles(mesh);
  const std::uint32_t hash = hash_of(options_.seed, index);
  std::vector<V2f> corners = texture_.layout.corners[index];
  if (corners.empty()) return true;
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t)
    if (!has_area(mesh, t))
      std::fill_n(corners.begin() + static_cast<std::ptrdiff_t>(3 * t), 3, V2f(0));
  const SampledTexels texels(mesh, corners, two_sided, options_, hash);
  const SmallParts parts = parts_of_texels(mesh, texels);
  // Neighbouring texels share no samples, so that a variance takes two of them.
  constexpr std::uint32_t kFirst = 2;
  ValueSums sums(parts, options_.sides);
  SampleRounds rounds(texels, hash, placements, tracing, sums, options_.sides);
  if (!rounds.run(round_options(options_, kFirst, placements, false))) return false;
  std::vector<PlaceValue> values = sums.values();
  std::vector<std::vector<V3f>> light;
  if (tracing.lights > 0) {
    ValueSums light_sums(parts, options_.sides, tracing.lights);
    SampleRounds light_rounds(texels, ~hash, placements, tracing, light_sums, options_.sides,
                              &sums);
    if (!light_rounds.run(round_options(options_, kFirst, placements, true))) return false;
    for (const float square : light_sums.squared_errors())
      tracing.statistics.squared_light_errors += double{square};
    for (std::size_t l = 0; l < tracing.lights; ++l) light.push_back(light_sums.light_values(l));
    for (std::uint32_t i = 0; i < values.size(); ++i)
      values[i].known = values[i].known && !light_sums.is_inside(i);
    texture_.light.resize(tracing.lights, std::vector<V3f>(texture_.ao.size(), V3f(0, 0, 0)));
  }
  for (const float square : sums.squared_errors())
    tracing.statistics.squared_errors += double{square};
  for (std::uint32_t i = 0; i < values.size(); ++i)
    tracing.statistics.sampled_values += sums.is_sampled(i) ? 1 : 0;
  add_values(texels, values, light, tracing.statistics);
  tracing.statistics.triangles += mesh.primitive_count();
  tracing.statistics.texels += texels.size();
  return true;
}

void TextureBake::add_values(const SampledTexels& texels, const std::vector<PlaceValue>& values,
                             const std::vector<std::vector<V3f>>& light,
                             BakeStatistics& statistics) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t texel = texels.texel(i);
    covered_[texel] = true;
    if (!values[i].known) {
      ++statistics.enclosed_texels;
      continue;
    }
    if (values[i].dark) ++statistics.dark_texels;
    float part = 0;
    for (const std::uint32_t t : texels.triangles(i)) part += texels.polygon(i, t).area();
    texture_.ao[texel] += part * values[i].ao;
    if (options_.bent) texture_.bent[texel] += values[i].bent * part;
    for (std::size_t l = 0; l < light.size(); ++l) texture_.light[l][texel] += light[l][i] * part;
    weight_[texel] += part;
    known_[texel] = true;
  }
}

void TextureBake::join_all_seams() {
  std::vector<SeamPoint> points;
  for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
    if (texture_.layout.corners[m].empty()) continue;
    const auto of_mesh = seam_points(scene_.meshes[m], texture_.layout.corners[m], texture_.size);
    points.insert(points.end(), of_mesh.begin(), of_mesh.end());
  }
  if (points.empty()) return;
  join_seams(points, texture_.ao);
  for (float& ao : texture_.ao) ao = std::clamp(ao, 0.0f, 1.0f);
  for (std::vector<V3f>& light : texture_.light) {
    join_seams(points, light);
    for (V3f& value : light)
      for (int c = 0; c < 3; ++c) value[c] = std::max(0.0f, value[c]);
  }
  if (texture_.bent.empty()) return;
  join_seams(points, texture_.bent);
  for (V3f& bent : texture_.bent) bent.normalize();
}

void TextureBake::take_nearest(const std::vector<std::uint32_t>& nearest, bool covered) {
  for (std::size_t i = 0; i < known_.size(); ++i) {
    if (known_[i] || nearest[i] == kNoTexel || covered_[i] != covered) continue;
    texture_.ao[i] = texture_.ao[nearest[i]];
    if (options_.bent) texture_.bent[i] = texture_.bent[nearest[i]];
    for (std::vector<V3f>& light : texture_.light) light[i] = light[nearest[i]];
    known_[i] = true;
  }
}

void TextureBake::fill_enclosed_texels(BakeStatistics& statistics) {
  const int all = static_cast<int>(texture_.size);
  if (known_ == covered_) return;
  take_nearest(nearest_valid(known_, texture_.size, all, covered_), true);
  // Texels that several meshes cover were counted for each of them.
  const auto left = std::count(covered_.begin(), covered_.end(), true) -
                    std::count(known_.begin(), known_.end(), true);
  statistics.enclosed_texels -=
      std::min(statistics.enclosed_texels, static_cast<std::size_t>(left));
}

void TextureBake::clear_beyond_margin() {
  for (std::size_t i = 0; i < known_.size(); ++i) {
    if (covered_[i] || (known_[i] && options_.margin > 0)) continue;
    texture_.ao[i] = 1;
    if (options_.bent) texture_.bent[i] = V3f(0, 0, 0);
    for (std::vector<V3f>& light : texture_.light) light[i] = V3f(0, 0, 0);
  }
}

BakedTexture TextureBake::finish(BakeStatistics& statistics) {
  for (std::size_t i = 0; i < known_.size(); ++i) {
    if (!known_[i]) continue;
    texture_.ao[i] /= weight_[i];
    if (options_.bent) texture_.bent[i].normalize();
    for (std::vector<V3f>& light : texture_.light) light[i] /= weight_[i];
  }
  fill_enclosed_texels(statistics);
  // Look-ups at seams read one texel beyond what is covered.
  take_nearest(nearest_valid(known_, texture_.size, std::max(1, options_.margin)), false);
  join_all_seams();
  clear_beyond_margin();
  const auto covered = std::count(covered_.begin(), covered_.end(), true);
  texture_.coverage = static_cast<double>(covered) / static_cast<double>(covered_.size());
  texture_.overlap = find_overlap(texture_.layout.corners, texture_.size).share;
  return std::move(texture_);
}

}  // namespace dapple
