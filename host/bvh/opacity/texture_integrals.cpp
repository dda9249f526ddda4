#include "bvh/opacity/texture_integrals.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "bvh/opacity/triangle_opacity.hpp"

namespace dapple {
namespace {

/// Whether alphas of corners differ.
bool is_varied(const TexturedCorners& corners) {
  return corners.alpha[0] != corners.alpha[1] || corners.alpha[1] != corners.alpha[2];
}

/// Parts of a side of a triangle whose cut-out varies over it.
constexpr std::size_t kDivisions = 8;

}  // namespace

std::shared_ptr<const OpacityMipLevels> SharedMipLevels::of(const OpacityTexture& texture) {
  const std::shared_ptr<Entry> entry = entry_of(texture);
  std::call_once(entry->made, [&] {
    const Texture& image = textures_[static_cast<std::size_t>(texture.texture)];
    // A thread that waits for its own tasks must not begin another object's, which may want these.
    tbb::this_task_arena::isolate([&] {
      entry->levels =
          std::make_shared<const OpacityMipLevels>(image, texture.factor, texture.cutoff);
    });
    keep(entry, mip_level_texels(image.width, image.height) * sizeof(float));
  });
  return {entry, entry->levels.get()};
}

std::shared_ptr<SharedMipLevels::Entry> SharedMipLevels::entry_of(const OpacityTexture& texture) {
  const std::lock_guard lock(mutex_);
  std::weak_ptr<Entry>& known = entries_[texture];
  std::shared_ptr<Entry> entry = known.lock();
  if (!entry) known = entry = std::make_shared<Entry>();
  return entry;
}

void SharedMipLevels::keep(std::shared_ptr<Entry> entry, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  kept_.emplace_back(std::move(entry), bytes);
  kept_bytes_ += bytes;
  while (kept_bytes_ > most_bytes_) {
    kept_bytes_ -= kept_.front().second;
    kept_.pop_front();
  }
}

TriangleIntegral::TriangleIntegral(const TexturedCorners& corners, const Material& material,
                                   const OpacityMipLevels* levels)
    : corners_(corners), factor_(material.alpha), cutoff_(cutoff_of(material)), levels_(levels) {
  if (!levels_) return;
  if (levels_->is_beyond_border(corners_.uv)) return;
  const auto& [a, b, c] = corners_.uv;
  const V2f e1 = (b - a) * levels_->size(), e2 = (c - a) * levels_->size();
  texels_ = 0.5f * std::fabs(e1.x * e2.y - e1.y * e2.x);
  const float longest = std::sqrt(std::max({e1.length2(), e2.length2(), (e2 - e1).length2()}));
  narrowest_ = longest > 0 ? 2 * texels_ / longest : 0;
}

float TriangleIntegral::mean(float u, float v, float share) const {
  const float w = 1.0f - u - v;
  const auto& alphas = corners_.alpha;
  const float alpha = factor_ * (alphas[0] * w + alphas[1] * u + alphas[2] * v);
  if (!levels_) return thresholded(alpha, cutoff_);
  const auto& [a, b, c] = corners_.uv;
  const V2f at = a * w + b * u + c * v;
  if (cutoff_ >= 0.0f && is_varied(corners_)) {
    constexpr float kMost = 0.5f;  // the largest share of a triangle that one point stands for
    if (share > kMost) return mean_of_parts(kDivisions);
    return thresholded(levels_->mean(at, 1) * alpha, cutoff_);
  }
  const float mean = levels_->mean(at, std::min(std::sqrt(texels_ * share), narrowest_));
  return cutoff_ < 0.0f ? std::clamp(mean * alpha, 0.0f, 1.0f) : mean;
}

float TriangleIntegral::mean_of_parts(std::size_t divisions) const {
  const auto n = static_cast<float>(divisions);
  const float share = 1 / (n * n);
  double sum = 0;
  for (std::size_t i = 0; i < divisions; ++i)
    for (std::size_t j = 0; i + j < divisions; ++j)
      for (const float third : {1.0f / 3, 2.0f / 3}) {
        if (third > 0.5f && i + j + 1 == divisions) continue;  // beyond the third side
        sum += double{
            mean((static_cast<float>(i) + third) / n, (static_cast<float>(j) + third) / n, share)};
      }
  return static_cast<float>(sum * double{share});
}

// The mean of a blended texture is linear in the factor, which is applied later. The mean of a
// cut-out texture is not, so there are mip levels for each factor, rounded. Where factors vary over
// a triangle, points of it are looked up.
OpacityTexture TextureIntegrals::texture_of(const TexturedCorners& corners) const {
  const Material& material = (*materials_)[corners.material];
  const float cutoff = cutoff_of(material);
  if (cutoff < 0.0f || is_varied(corners)) return {material.alpha_texture, 1.0f, -1.0f};
  const float factor = material.alpha * corners.alpha[0];
  return {material.alpha_texture, std::round(factor * 64.0f) / 64.0f, cutoff};
}

TextureIntegrals::TextureIntegrals(const Scene& scene, std::span<const TexturedTriangle> textured,
                                   SharedMipLevels& shared)
    : materials_(&scene.materials) {
  std::vector<OpacityTexture> needed;
  for (const TexturedTriangle& triangle : textured) {
    const TexturedCorners corners = unpack_textured(triangle);
    if (!corners.has_texture) continue;
    const OpacityTexture texture = texture_of(corners);
    if (needed.empty() || needed.back() != texture) needed.push_back(texture);
  }
  std::sort(needed.begin(), needed.end());
  needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
  levels_.reserve(needed.size());
  for (const OpacityTexture& texture : needed) levels_.emplace_back(texture, shared.of(texture));
}

TextureIntegrals::TextureIntegrals(const Scene& scene, std::span<const TexturedTriangle> textured)
    : materials_(&scene.materials) {
  SharedMipLevels own(scene);
  levels_ = TextureIntegrals(scene, textured, own).levels_;
}

TriangleIntegral TextureIntegrals::of(const TexturedTriangle& triangle) const {
  const TexturedCorners corners = unpack_textured(triangle);
  const OpacityMipLevels* levels = nullptr;
  if (corners.has_texture) {
    const OpacityTexture texture = texture_of(corners);
    const auto at =
        std::lower_bound(levels_.begin(), levels_.end(), texture,
                         [](const auto& one, const OpacityTexture& of) { return one.first < of; });
    if (at != levels_.end() && at->first == texture) levels = at->second.get();
  }
  return {corners, (*materials_)[corners.material], levels};
}

}  // namespace dapple
