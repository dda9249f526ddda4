#include "device/upload/color_upload.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "bvh/opacity/opacity_mip_levels.hpp"
#include "bvh/storage/textured_triangle.hpp"
#include "dapple/error.hpp"
#include "device/upload/color_mip_levels.hpp"
#include "device/upload/texture_upload.hpp"

namespace dapple {
namespace {

/// Blocks of one task of a parallel loop.
constexpr std::size_t kGrain = 1u << 11;

/// Words beyond this number cannot be told from those with DAPPLE_COLOR_LANES.
constexpr std::size_t kMaxWords = DAPPLE_COLOR_LANES;

uint code(float value, int largest) {
  const float inside = value > 0 ? std::min(value, 1.0f) : 0.0f;  // 0 for NaN
  return static_cast<uint>(std::sqrt(inside) * static_cast<float>(largest) + 0.5f);
}

uint packed(const V3f& linear) {
  return code(linear.x, DAPPLE_RED_CODES) | code(linear.y, DAPPLE_GREEN_CODES) << 11 |
         code(linear.z, DAPPLE_BLUE_CODES) << 22;
}

[[noreturn]] void refuse_size(const Scene& scene, const char* what) {
  throw Error(ErrorKind::failed,
              fmt::format("{}: too many {} for the albedo's indices; leave it out of --passes",
                          scene.source, what));
}

/// Appends the texture and its mip levels. Returns where each begins.
std::vector<uint> pack_levels(const Scene& scene, const ColorTexture& texture,
                              const TexelWeights& of_material, std::vector<uint>& texels) {
  const TexelWeights weights = weights_of_seen(texture, of_material);
  std::vector<uint> offsets;
  const auto begin = [&] {
    if (texels.size() >= std::numeric_limits<uint>::max()) refuse_size(scene, "texels");
    offsets.push_back(static_cast<uint>(texels.size()));
  };
  const auto append = [&](std::uint32_t width, std::uint32_t height, const auto& code_of) {
    begin();
    const std::size_t first = texels.size();
    texels.resize(first + std::size_t{width} * height);
    tbb::parallel_for(0u, height, [&](std::uint32_t y) {
      uint* to = &texels[first + std::size_t{y} * width];
      for (std::uint32_t x = 0; x < width; ++x) *to++ = code_of(x, y);
    });
  };
  std::array<uint, 256> red{}, green{}, blue{};
  for (std::size_t c = 0; c < 256; ++c) {
    red[c] = code(linear_of_codes()[c], DAPPLE_RED_CODES);
    green[c] = code(linear_of_codes()[c], DAPPLE_GREEN_CODES) << 11;
    blue[c] = code(linear_of_codes()[c], DAPPLE_BLUE_CODES) << 22;
  }
  const std::vector<ColorLevel> levels = color_mip_levels(texture, weights);
  append(texture.width, texture.height, [&](std::uint32_t x, std::uint32_t y) {
    const std::size_t i = std::size_t{y} * texture.width + x;
    if (!levels.empty() && !is_seen(texture, weights, i))
      return packed(color_of_unseen(texture, weights, levels.front(), x, y));
    const std::uint8_t* texel = &texture.rgb[3 * i];
    return red[texel[0]] | green[texel[1]] | blue[texel[2]];
  });
  for (const ColorLevel& level : levels) {
    if (offsets.size() > DAPPLE_MAX_MIPS) break;
    append(level.width, level.height, [&](std::uint32_t x, std::uint32_t y) {
      return packed(level.color[std::size_t{y} * level.width + x]);
    });
  }
  return offsets;
}

void pack_materials(const Scene& scene, SurfaceColors& colors) {
  std::map<std::pair<int, TexelWeights>, std::vector<uint>> levels;
  std::size_t texels = 0;  // most of them have one kind of weights
  for (const ColorTexture& texture : scene.color_textures)
    texels += mip_level_texels(texture.width, texture.height);
  colors.texels.reserve(texels);
  for (const Material& material : scene.materials) {
    ColorMaterial record{};
    for (int channel = 0; channel < 3; ++channel) record.color[channel] = material.color[channel];
    if (material.color_texture >= 0) {
      const ColorTexture& texture = scene.color_textures[material.color_texture];
      const TexelWeights weights = texel_weights(material);
      const auto [known, is_new] = levels.try_emplace({material.color_texture, weights});
      if (is_new) known->second = pack_levels(scene, texture, weights, colors.texels);
      const std::vector<uint>& offsets = known->second;
      record.mips = static_cast<uint>(offsets.size()) - 1;
      record.width = texture.width;
      record.height = texture.height;
      record.flags = texture_flags(texture.wrap_s, texture.wrap_t, texture.nearest);
      std::copy(offsets.begin(), offsets.end(), record.offset);
    }
    colors.materials.push_back(record);
  }
}

/// Whether coordinates of one, without the whole tiles that it repeats, are those of the other.
bool wrap_alike(const Texture& alpha, const ColorTexture& color) {
  return alpha.wrap_s == color.wrap_s && alpha.wrap_t == color.wrap_t;
}

/// The entries of a mesh's surfaces.
class MeshEntries {
 public:
  MeshEntries(const Scene& scene, const SceneBvh& bvh, const Mesh& mesh, std::size_t first_lane,
              std::size_t first_block)
      : scene_(scene),
        bvh_(bvh),
        mesh_(mesh),
        primitives_(bvh.primitives.data() + first_lane),
        first_block_(first_block) {}

  /// The flags of a lane's entry. Lanes without a primitive of the mesh have those of material 0.
  [[nodiscard]] uint flags(std::size_t lane) const {
    const std::uint32_t primitive = primitives_[lane];
    if (primitive >= mesh_.primitive_count()) return 0;
    const Material& material = scene_.materials[mesh_.materials[primitive]];
    uint flags = mesh_.materials[primitive];
    if (!mesh_.colors.empty()) flags |= DAPPLE_COLOR_CORNERS;
    if (material.color_texture < 0 || mesh_.uvs.empty() || mesh_.has_strands()) return flags;
    const TriangleBlock& block = bvh_.blocks[first_block_ + lane / 8];
    const bool of_opacity = material.alpha_texture >= 0 && block.opacity[lane % 8] < 0 &&
                            wrap_alike(scene_.textures[material.alpha_texture],
                                       scene_.color_textures[material.color_texture]);
    return flags | (of_opacity ? DAPPLE_COLOR_OPACITY_UVS : DAPPLE_COLOR_UVS);
  }

  [[nodiscard]] std::size_t size(uint flags) const {
    if ((flags & (DAPPLE_COLOR_UVS | DAPPLE_COLOR_CORNERS)) == 0) return 0;  // a shared entry
    return 1 + (flags & DAPPLE_COLOR_UVS ? 6 : 0) + (flags & DAPPLE_COLOR_CORNERS ? corners() : 0);
  }

  /// The flags of all lanes of a block that hold a primitive, if these share an entry.
  [[nodiscard]] std::optional<uint> common_flags(std::size_t block) const {
    std::optional<uint> common;
    for (std::size_t lane = 8 * block; lane < 8 * block + 8; ++lane) {
      if (primitives_[lane] >= mesh_.primitive_count()) continue;
      const uint of_lane = flags(lane);
      if (size(of_lane) > 0 || (common && *common != of_lane)) return {};
      common = of_lane;
    }
    return common.value_or(0);
  }

  /// Number of words that a block takes besides the one that each has.
  [[nodiscard]] std::size_t block_size(std::size_t block) const {
    if (common_flags(block)) return 0;
    std::size_t words = 8;
    for (std::size_t lane = 8 * block; lane < 8 * block + 8; ++lane) words += size(flags(lane));
    return words;
  }

  void write(std::size_t lane, uint flags, uint* entry) const {
    const std::uint32_t* at = &mesh_.indices[corners() * primitives_[lane]];
    *entry++ = flags;
    if (flags & DAPPLE_COLOR_UVS) {
      const TexturedTriangle triangle = coordinates(at, primitives_[lane]);
      for (const auto& corner : triangle.corner) entry = std::copy_n(corner, 2, entry);
    }
    if (flags & DAPPLE_COLOR_CORNERS) {
      for (std::size_t k = 0; k < corners(); ++k) *entry++ = packed(mesh_.colors[at[k]]);
    }
  }

 private:
  [[nodiscard]] std::size_t corners() const { return mesh_.has_strands() ? 2 : 3; }

  [[nodiscard]] TexturedTriangle coordinates(const std::uint32_t* at, std::size_t triangle) const {
    const ColorTexture& texture =
        scene_.color_textures[scene_.materials[mesh_.materials[triangle]].color_texture];
    const V2f size(static_cast<float>(texture.width), static_cast<float>(texture.height));
    TexturedCorners corners;
    for (int k = 0; k < 3; ++k) corners.uv[k] = mesh_.uvs[at[k]];
    corners.has_texture = true;
    const V3f edge1 = mesh_.positions[at[1]] - mesh_.positions[at[0]];
    const V3f edge2 = mesh_.positions[at[2]] - mesh_.positions[at[0]];
    const float texels = std::fabs(
        ((corners.uv[1] - corners.uv[0]) * size).cross((corners.uv[2] - corners.uv[0]) * size));
    if (texels > 0) corners.texel_size = std::sqrt(edge1.cross(edge2).length() / texels);
    return pack_textured(corners, texture.wrap_s, texture.wrap_t);
  }

  const Scene& scene_;
  const SceneBvh& bvh_;
  const Mesh& mesh_;
  const std::uint32_t* primitives_;
  std::size_t first_block_;
};

/// Where the shared entry of a material begins: there is one without and one with coordinates.
uint shared_entry(std::size_t first, uint flags) {
  return static_cast<uint>(first + 2 * std::size_t{flags & DAPPLE_COLOR_MATERIAL} +
                           (flags & DAPPLE_COLOR_OPACITY_UVS ? 1 : 0));
}

/// Writes the words of a block: its own, and those that begin at `at`.
void write_block(const MeshEntries& entries, std::size_t block, std::size_t word, std::size_t at,
                 std::size_t shared, std::vector<uint>& words) {
  if (const auto common = entries.common_flags(block)) {
    words[word] = shared_entry(shared, *common);
    return;
  }
  words[word] = static_cast<uint>(at) | DAPPLE_COLOR_LANES;
  std::size_t next = at + 8;
  for (std::size_t lane = 0; lane < 8; ++lane) {
    const uint flags = entries.flags(8 * block + lane);
    const std::size_t size = entries.size(flags);
    words[at + lane] = size > 0 ? static_cast<uint>(next) : shared_entry(shared, flags);
    if (size > 0) entries.write(8 * block + lane, flags, &words[next]);
    next += size;
  }
}

/// Writes the words of a mesh's `count` blocks, the first at `first_word`, and appends what they
/// need besides. `shared`: where the shared entries begin.
void pack_mesh(const Scene& scene, const MeshEntries& entries, std::size_t first_word,
               std::size_t count, std::size_t shared, std::vector<uint>& words) {
  const std::size_t tasks = (count + kGrain - 1) / kGrain;
  std::vector<std::size_t> next(tasks + 1, 0);
  const auto for_blocks = [&](std::size_t task, const auto& body) {
    for (std::size_t b = task * kGrain; b < std::min(count, (task + 1) * kGrain); ++b) body(b);
  };
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    for_blocks(task, [&](std::size_t block) { next[task + 1] += entries.block_size(block); });
  });
  next[0] = words.size();
  for (std::size_t task = 0; task < tasks; ++task) next[task + 1] += next[task];
  if (next[tasks] > kMaxWords) refuse_size(scene, "triangles");
  words.resize(next[tasks]);
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    std::size_t at = next[task];
    for_blocks(task, [&](std::size_t block) {
      write_block(entries, block, first_word + block, at, shared, words);
      at += entries.block_size(block);
    });
  });
}

}  // namespace

Checksum color_key(const Scene& scene) {
  ChecksumStream key;
  for (const ColorTexture& texture : scene.color_textures) {
    key.add_value(texture.width);
    key.add_value(texture.height);
    key.add_value(texture.wrap_s);
    key.add_value(texture.wrap_t);
    key.add_value(static_cast<std::uint8_t>(texture.nearest));
    key.add_range(texture.rgb);
    key.add_range(texture.alpha);
  }
  for (const Material& material : scene.materials) {
    for (int channel = 0; channel < 3; ++channel) key.add_value(material.color[channel]);
    key.add_value(material.color_texture);
    const TexelWeights weights = texel_weights(material);
    key.add_value(weights.kind);
    key.add_value(weights.least_seen);
  }
  for (const Mesh& mesh : scene.meshes) {
    key.add_range(mesh.materials);
    key.add_range(mesh.uvs);
    key.add_range(mesh.colors);
  }
  return key.value();
}

std::vector<uint> pack_color_words(const Scene& scene, const SceneBvh& bvh) {
  const std::size_t blocks = bvh.blocks.size() + bvh.segments.size();
  const std::size_t shared = 2 * scene.materials.size();
  if (blocks + shared > kMaxWords) refuse_size(scene, "triangles");
  std::vector<uint> words(blocks + shared);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    words[blocks + 2 * m] = static_cast<uint>(m);
    words[blocks + 2 * m + 1] = static_cast<uint>(m) | DAPPLE_COLOR_OPACITY_UVS;
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const ObjectOffsets &first = bvh.objects[m], &end = bvh.objects[m + 1];
    const bool strands = scene.meshes[m].has_strands();
    // Blocks of triangles come first, then those of segments.
    const std::size_t first_word = strands ? bvh.blocks.size() + first.segments : first.block;
    pack_mesh(scene, {scene, bvh, scene.meshes[m], first.lane(), first.block}, first_word,
              (end.lane() - first.lane()) / 8, blocks, words);
  }
  return words;
}

SurfaceColors pack_colors(const Scene& scene, const SceneBvh& bvh) {
  SurfaceColors colors;
  pack_materials(scene, colors);
  colors.words = pack_color_words(scene, bvh);
  return colors;
}

}  // namespace dapple
