#include "device/upload/texture_upload.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>

#include "bvh/opacity/triangle_opacity.hpp"

namespace dapple {
namespace {

/// Textures and their mip levels begin at multiples of this many bytes; offsets count such units.
constexpr std::size_t kOffsetUnit = 16;

static_assert(static_cast<uint>(Wrap::repeat) == DAPPLE_WRAP_REPEAT);
static_assert(static_cast<uint>(Wrap::clamp) == DAPPLE_WRAP_CLAMP);
static_assert(static_cast<uint>(Wrap::mirror) == DAPPLE_WRAP_MIRROR);

uint next_offset(std::vector<uchar>& texels) {
  texels.resize((texels.size() + kOffsetUnit - 1) / kOffsetUnit * kOffsetUnit);
  return static_cast<uint>(texels.size() / kOffsetUnit);
}

TextureRecord pack_texture(const Texture& texture, std::vector<uchar>& texels) {
  TextureRecord record{};
  record.offset = next_offset(texels);
  record.width = texture.width;
  record.height = texture.height;
  record.flags = texture_flags(texture.wrap_s, texture.wrap_t, texture.nearest);
  texels.insert(texels.end(), texture.alpha.begin(), texture.alpha.end());
  return record;
}

/// Appends the mip levels above the texture itself, at most DAPPLE_MAX_MIPS. Returns their offsets,
/// finest first.
std::vector<uint> pack_mips(const Texture& texture, float factor, float cutoff,
                            std::vector<uchar>& texels) {
  const OpacityMipLevels mip_levels(texture, factor, cutoff);
  std::vector<uint> offsets;
  for (std::size_t level = 1; level < mip_levels.levels().size(); ++level) {
    if (offsets.size() == DAPPLE_MAX_MIPS) break;
    offsets.push_back(next_offset(texels));
    for (const float opacity : mip_levels.levels()[level].opacity)
      texels.push_back(static_cast<uchar>(std::lround(255.0f * opacity)));
  }
  return offsets;
}

}  // namespace

uint texture_flags(Wrap s, Wrap t, bool nearest) {
  return DAPPLE_TEXTURE_FLAGS(static_cast<uint>(s), static_cast<uint>(t)) |
         (nearest ? DAPPLE_NEAREST : 0u);
}

void pack_materials(const Scene& scene, std::vector<MaterialRecord>& records,
                    std::vector<uchar>& texels) {
  std::vector<TextureRecord> textures;
  for (const Texture& texture : scene.textures) textures.push_back(pack_texture(texture, texels));
  std::map<std::tuple<int, float, float>, std::vector<uint>> mips;
  for (const Material& material : scene.materials) {
    MaterialRecord record{};
    record.alpha = material.alpha;
    record.cutoff = cutoff_of(material);
    if (material.alpha_texture >= 0) {
      record.texture = textures[material.alpha_texture];
      if (material.alpha_mode != AlphaMode::opaque) {
        // A blended opacity is proportional to the factor, so the kernels can apply it later.
        const float factor = record.cutoff < 0 ? 1.0f : material.alpha;
        const auto [at, is_new] = mips.try_emplace({material.alpha_texture, factor, record.cutoff});
        if (is_new) {
          at->second =
              pack_mips(scene.textures[material.alpha_texture], factor, record.cutoff, texels);
        }
        record.mips = static_cast<uint>(at->second.size());
        std::copy(at->second.begin(), at->second.end(), record.mip_offset);
      }
    }
    records.push_back(record);
  }
}

}  // namespace dapple
