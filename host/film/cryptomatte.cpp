#include "film/cryptomatte.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>

namespace dapple {
namespace {

constexpr std::size_t kMaxLayers = 3;  // of two ids each: six, as the specification suggests

std::uint32_t mixed(std::uint32_t block) {
  return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u;
}

/// An id and the share of a pixel's samples that hit it.
struct Rank {
  std::uint32_t id = 0;
  std::uint32_t count = 0;
};

/// Writes the ids of a pixel to `ranks`, those with the largest shares first; `id_of` tells the id
/// of a slot.
template <class IdOf>
void rank_ids(const MatteSums& sums, std::size_t pixel, const IdOf& id_of,
              std::vector<Rank>& ranks) {
  ranks.clear();
  sums.for_each_slot(pixel, [&](const MatteSlot& slot) {
    const std::uint32_t id = id_of(slot);
    const auto found =
        std::find_if(ranks.begin(), ranks.end(), [&](const Rank& rank) { return rank.id == id; });
    if (found == ranks.end())
      ranks.push_back({id, slot.count});
    else
      found->count += slot.count;
  });
  std::sort(ranks.begin(), ranks.end(), [](const Rank& a, const Rank& b) {
    return a.count != b.count ? a.count > b.count : a.id < b.id;
  });
}

/// The first ranks of each pixel as channels R (id), G (coverage), B (id), A (coverage) of layers.
/// No pixel has more ids than there are names, so that all frames have the same layers.
template <class IdOf>
void add_layers(Film& film, const std::string& type, const MatteSums& sums,
                const std::vector<std::uint32_t>& samples, std::size_t names, const IdOf& id_of) {
  const std::size_t first = film.planes.size();
  const std::size_t layers = std::clamp<std::size_t>((names + 1) / 2, 1, kMaxLayers);
  for (std::size_t layer = 0; layer < layers; ++layer)
    for (const char channel : {'R', 'G', 'B', 'A'})
      film.planes.push_back({fmt::format("{}{:02}.{}", type, layer, channel),
                             std::vector<float>(sums.pixel_count())});
  const auto add = [&](const tbb::blocked_range<std::size_t>& pixels) {
    std::vector<Rank> ranks;
    for (std::size_t p = pixels.begin(); p < pixels.end(); ++p) {
      rank_ids(sums, p, id_of, ranks);
      for (std::size_t r = 0; r < std::min(2 * layers, ranks.size()); ++r) {
        film.planes[first + 2 * r].pixels[p] = std::bit_cast<float>(ranks[r].id);
        film.planes[first + 2 * r + 1].pixels[p] =
            static_cast<float>(double{1} * ranks[r].count / samples[p]);
      }
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sums.pixel_count(), 4096), add);
}

/// The metadata of a type: its key is the beginning of its name's hash.
void add_attributes(FilmMetadata& metadata, const std::string& type,
                    const std::vector<std::string>& names) {
  nlohmann::json manifest = nlohmann::json::object();  // in ordered_json a name takes linear time
  for (const std::string& name : names) manifest[name] = fmt::format("{:08x}", matte_id(name));
  const std::string key =
      "cryptomatte/" + fmt::format("{:08x}", murmur3_32(type)).substr(0, 7) + "/";
  metadata.attributes.emplace_back(key + "name", type);
  metadata.attributes.emplace_back(key + "hash", "MurmurHash3_32");
  metadata.attributes.emplace_back(key + "conversion", "uint32_to_float32");
  metadata.attributes.emplace_back(
      key + "manifest", manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::vector<std::uint32_t> ids_of(const std::vector<std::string>& names) {
  std::vector<std::uint32_t> ids;
  for (const std::string& name : names) ids.push_back(matte_id(name));
  return ids;
}

}  // namespace

std::uint32_t murmur3_32(std::string_view bytes) {
  const auto byte = [&](std::size_t i) -> std::uint32_t {
    return static_cast<unsigned char>(bytes[i]);
  };
  std::uint32_t hash = 0;
  std::size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4) {
    hash ^= mixed(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24);
    hash = std::rotl(hash, 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t rest = 0;
  for (std::size_t k = i; k < bytes.size(); ++k) rest |= byte(k) << (8 * (k - i));
  hash ^= mixed(rest);
  hash ^= static_cast<std::uint32_t>(bytes.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

std::uint32_t matte_id(std::string_view name) {
  const std::uint32_t hash = murmur3_32(name);
  const std::uint32_t exponent = std::clamp(hash >> 23 & 0xffu, 1u, 254u);
  return (hash & 0x807fffffu) | exponent << 23;
}

void add_cryptomattes(Film& film, const MatteSums& sums, const std::vector<std::uint32_t>& samples,
                      const MatteNames& names, const Cryptomattes& wanted) {
  const auto add = [&](const std::string& type, const std::vector<std::string>& of_type,
                       std::uint32_t MatteSlot::*number) {
    const std::vector<std::uint32_t> ids = ids_of(of_type);
    add_layers(film, type, sums, samples, ids.size(),
               [&](const MatteSlot& slot) { return ids[slot.*number]; });
    add_attributes(film.metadata, type, of_type);
  };
  if (wanted.objects) add("crypto_object", names.objects, &MatteSlot::object);
  if (wanted.materials) add("crypto_material", names.materials, &MatteSlot::material);
}

}  // namespace dapple
