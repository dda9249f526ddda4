#include "scene/gltf/edit/compaction.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/edit/extension_use.hpp"

namespace dapple::gltf {
namespace {

/// Is called with every reference to an element of an array of the document: an index.
using Visit = std::function<void(Json&)>;

void visit_member(Json& object, const char* key, const Visit& visit) {
  if (object.is_object() && object.contains(key)) visit(object[key]);
}

void visit_all(Json& object, const char* key, const Visit& visit) {
  if (!object.is_object() || !object.contains(key)) return;
  for (Json& element : object[key]) visit(element);
}

void for_each_primitive(Json& document, const Visit& visit) {
  visit_all(document, "meshes", [&](Json& mesh) { visit_all(mesh, "primitives", visit); });
}

void for_each_accessor(Json& document, const Visit& visit) {
  for_each_primitive(document, [&](Json& primitive) {
    visit_all(primitive, "attributes", visit);
    visit_member(primitive, "indices", visit);
    visit_all(primitive, "targets", [&](Json& target) {
      for (Json& accessor : target) visit(accessor);
    });
  });
  visit_all(document, "animations", [&](Json& animation) {
    visit_all(animation, "samplers", [&](Json& sampler) {
      visit_member(sampler, "input", visit);
      visit_member(sampler, "output", visit);
    });
  });
  visit_all(document, "skins",
            [&](Json& skin) { visit_member(skin, "inverseBindMatrices", visit); });
  visit_all(document, "nodes", [&](Json& node) {
    if (has_extension(node, extension::kInstancing))
      visit_all(node["extensions"][extension::kInstancing], "attributes", visit);
  });
}

void for_each_view(Json& document, const Visit& visit) {
  visit_all(document, "accessors", [&](Json& accessor) {
    visit_member(accessor, "bufferView", visit);
    visit_member(accessor, "sparse", [&](Json& sparse) {
      for (const char* part : {"indices", "values"})
        visit_member(sparse, part, [&](Json& of) { visit_member(of, "bufferView", visit); });
    });
  });
  visit_all(document, "images", [&](Json& image) { visit_member(image, "bufferView", visit); });
  for_each_primitive(document, [&](Json& primitive) {
    if (has_extension(primitive, extension::kDraco))
      visit_member(primitive["extensions"][extension::kDraco], "bufferView", visit);
  });
}

/// Textures are named by "index" of members like "occlusionTexture", of extensions, too.
void for_each_texture(Json& element, const Visit& visit) {
  if (!element.is_structured()) return;
  for (auto& [key, value] : element.items()) {
    if (key.ends_with("Texture")) visit_member(value, "index", visit);
    if (key != "extras") for_each_texture(value, visit);
  }
}

void for_each_image(Json& document, const Visit& visit) {
  visit_all(document, "textures", [&](Json& texture) {
    visit_member(texture, "source", visit);
    visit_all(texture, "extensions",
              [&](Json& extension) { visit_member(extension, "source", visit); });
  });
}

void for_each_sampler(Json& document, const Visit& visit) {
  visit_all(document, "textures", [&](Json& texture) { visit_member(texture, "sampler", visit); });
}

/// An array of the document, and who refers to its elements.
struct Kind {
  const char* array;
  void (*for_each)(Json& document, const Visit& visit);
};

/// In an order in which those that refer come before those that they refer to.
constexpr Kind kKinds[] = {
    {"textures",
     [](Json& document, const Visit& visit) {
       visit_all(document, "materials", [&](Json& material) { for_each_texture(material, visit); });
     }},
    {"samplers", for_each_sampler},
    {"images", for_each_image},
    {"accessors", for_each_accessor},
    {"bufferViews", for_each_view},
};

/// Calls visit(name) for extensions that the document lists, and for those that it has anyhow.
void for_each_extension(const Json& element, const std::function<void(const std::string&)>& visit) {
  if (!element.is_structured()) return;
  for (const auto& [key, value] : element.items()) {
    if (key == "extras") continue;
    if (key == "extensionsUsed") {
      for (const Json& name : value) visit(name.is_string() ? name.get<std::string>() : "");
    } else if (key == "extensions" && value.is_object()) {
      for (const auto& [name, extension] : value.items()) visit(name);
    }
    for_each_extension(value, visit);
  }
}

/// Whether all references in the document are among those that are visited here.
bool is_known_whole(const Json& document) {
  static const std::set<std::string, std::less<>> kKnown = {
      extension::kDraco,        extension::kInstancing,  extension::kMeshopt,
      extension::kWebp,         "KHR_animation_pointer", extension::kLights,
      extension::kQuantization, "KHR_texture_basisu",    extension::kTextureTransform,
      "KHR_xmp_json_ld"};
  bool are_known = true;
  for_each_extension(document, [&](const std::string& name) {
    are_known = are_known && (kKnown.contains(name) || name.starts_with("KHR_materials_"));
  });
  return are_known;
}

std::set<std::size_t> used_elements(Json& document, const Kind& kind) {
  std::set<std::size_t> used;
  kind.for_each(document, [&](Json& index) {
    if (index.is_number_integer()) used.insert(index.get<std::size_t>());
  });
  return used;
}

/// Returns the elements that lost their last use. The last new elements take their places.
std::vector<Json> drop_elements(Json& before, Json& after, const Kind& kind) {
  if (!before.contains(kind.array)) return {};
  Json& elements = after[kind.array];
  const std::size_t old_count = before[kind.array].size();
  std::set<std::size_t> places = used_elements(before, kind);
  for (std::size_t added = old_count; added < elements.size(); ++added) places.insert(added);
  for (const std::size_t used : used_elements(after, kind)) places.erase(used);
  std::vector<Json> dropped;
  std::map<std::size_t, std::size_t> moved;  // from, to
  for (auto at = places.rbegin(); at != places.rend(); ++at) {
    const std::size_t place = *at;
    const std::size_t last = elements.size() - 1;
    if (last != place && last < old_count) continue;
    dropped.push_back(std::move(elements[place]));
    if (last != place) {
      elements[place] = std::move(elements[last]);
      moved[last] = place;
    }
    elements.erase(last);
  }
  kind.for_each(after, [&](Json& index) {
    const auto at = index.is_number_integer() ? moved.find(index.get<std::size_t>()) : moved.end();
    if (at != moved.end()) index = at->second;
  });
  if (elements.empty()) after.erase(kind.array);
  return dropped;
}

/// Bytes from `first` to before `second`.
using ByteRange = std::pair<std::size_t, std::size_t>;

ByteRange range_of(const Json& view) {
  const std::size_t begin = view.value("byteOffset", std::size_t{0});
  return {begin, begin + view["byteLength"].get<std::size_t>()};
}

/// Calls visit(part) for what of views is in the first buffer: a view, or the compressed data that
/// its extension names.
template <class Views>
void for_each_part(Views& views, const auto& visit) {
  for (auto& view : views) {
    if (view["buffer"] == 0) visit(view);
    if (!has_extension(view, extension::kMeshopt)) continue;
    auto& compressed = view["extensions"][extension::kMeshopt];
    if (compressed["buffer"] == 0) visit(compressed);
  }
}

/// In order, those that overlap or touch as one.
std::vector<ByteRange> merged(std::vector<ByteRange> ranges) {
  std::sort(ranges.begin(), ranges.end());
  std::vector<ByteRange> out;
  for (const ByteRange& range : ranges) {
    if (!out.empty() && range.first <= out.back().second)
      out.back().second = std::max(out.back().second, range.second);
    else
      out.push_back(range);
  }
  return out;
}

/// The parts of `ranges` that are in none of `used`; both are merged().
std::vector<ByteRange> without(const std::vector<ByteRange>& ranges,
                               const std::vector<ByteRange>& used) {
  std::vector<ByteRange> free;
  auto next = used.begin();
  for (auto [begin, end] : ranges) {
    while (next != used.end() && next->second <= begin) ++next;
    for (auto u = next; u != used.end() && u->first < end; ++u) {
      if (u->first > begin) free.emplace_back(begin, u->first);
      begin = std::max(begin, u->second);
    }
    if (begin < end) free.emplace_back(begin, end);
  }
  return free;
}

/// The ranges without what comes before the first and after the last multiple of eight: what comes
/// after them stays as aligned as it is when they are cut out.
std::vector<ByteRange> whole_eights(const std::vector<ByteRange>& ranges) {
  std::vector<ByteRange> whole;
  for (const auto& [begin, end] : ranges)
    if ((begin + 7) / 8 < end / 8) whole.emplace_back((begin + 7) / 8 * 8, end / 8 * 8);
  return whole;
}

/// Cuts the bytes of dropped views out of the first buffer.
void cut_bytes(const std::vector<Json>& dropped, Json& document, std::string& binary) {
  const auto ranges_of = [](const auto& views) {
    std::vector<ByteRange> ranges;
    for_each_part(views, [&](const Json& part) { ranges.push_back(range_of(part)); });
    return merged(std::move(ranges));
  };
  Json& views = document["bufferViews"];
  const std::vector<ByteRange> cuts = whole_eights(without(ranges_of(dropped), ranges_of(views)));
  std::string kept;
  std::map<std::size_t, std::size_t> cut_by_end{{0, 0}};  // up to an end of a cut, by that end
  std::size_t done = 0, cut_count = 0;
  for (const auto& [begin, end] : cuts) {
    kept.append(binary, done, begin - done);
    cut_by_end[done = end] = cut_count += end - begin;
  }
  binary = std::move(kept.append(binary, done));
  for_each_part(views, [&](Json& part) {
    const std::size_t begin = range_of(part).first;
    const std::size_t before = std::prev(cut_by_end.upper_bound(begin))->second;
    if (before > 0) part["byteOffset"] = begin - before;
  });
}

}  // namespace

void drop_unused(const Json& before, Json& after, std::string& binary) {
  if (!is_known_whole(before) || !is_known_whole(after)) return;
  Json old = before;
  std::vector<Json> views;
  for (const Kind& kind : kKinds) {
    std::vector<Json> dropped = drop_elements(old, after, kind);
    if (kind.array == std::string_view("bufferViews")) views = std::move(dropped);
  }
  if (!views.empty() && after.contains("bufferViews")) cut_bytes(views, after, binary);
}

}  // namespace dapple::gltf
