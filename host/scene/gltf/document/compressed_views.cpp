// Only this file uses meshoptimizer: see compressed_views.hpp.
#include "scene/gltf/document/compressed_views.hpp"

#include <meshoptimizer.h>

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>

#include "scene/gltf/document/element_check.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

/// The codec of attributes needs a byte for 64 equal values of a byte, other codecs more: a larger
/// buffer is not filled by its views.
constexpr std::uint64_t kMaxRatio = 64;

/// A compressed view, as EXT_meshopt_compression names its parts.
struct CompressedView {
  std::span<const std::uint8_t> bytes;
  std::uint64_t count = 0, stride = 0;
  std::string mode, filter;
};

CompressedView compressed_view(const Document& document, const Json& view, const std::string& who) {
  const auto extensions = view.find("extensions");
  if (extensions == view.end() || !extensions->contains(extension::kMeshopt))
    fail(document.file, "{} is in a buffer without bytes, and is not compressed", who);
  const Json& json = extensions->at(extension::kMeshopt);
  const auto buffer = json["buffer"].get<int>();
  const ElementCheck check(document.file);
  check.index(who + " (compressed)", "buffer", buffer, document.buffers.size());
  const auto all = document.buffers[static_cast<std::size_t>(buffer)];
  const auto offset = json.value("byteOffset", std::uint64_t{0});
  const auto length = json["byteLength"].get<std::uint64_t>();
  check.range(who + " (compressed)", offset + length, all.size(), fmt::format("buffer {}", buffer));
  return {all.subspan(offset, length), json["count"].get<std::uint64_t>(),
          json["byteStride"].get<std::uint64_t>(), json["mode"].get<std::string>(),
          json.value("filter", std::string("NONE"))};
}

/// The sizes of elements that the specification of EXT_meshopt_compression allows; the decoders
/// take them for granted.
bool has_valid_stride(const CompressedView& view) {
  const std::uint64_t stride = view.stride;
  if (view.mode != "ATTRIBUTES")
    return (stride == 2 || stride == 4) && view.filter == "NONE" &&
           (view.mode != "TRIANGLES" || view.count % 3 == 0);
  if (view.filter == "OCTAHEDRAL") return stride == 4 || stride == 8;
  if (view.filter == "QUATERNION") return stride == 8;
  return stride % 4 == 0 && stride >= 4 && stride <= 256;
}

bool decode(const CompressedView& view, std::uint8_t* out) {
  const auto [bytes, count, stride, mode, filter] = view;
  if (mode == "TRIANGLES")
    return meshopt_decodeIndexBuffer(out, count, stride, bytes.data(), bytes.size()) == 0;
  if (mode == "INDICES")
    return meshopt_decodeIndexSequence(out, count, stride, bytes.data(), bytes.size()) == 0;
  if (meshopt_decodeVertexBuffer(out, count, stride, bytes.data(), bytes.size()) != 0) return false;
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out, count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(out, count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(out, count, stride);
  return true;
}

void decode_view(const Document& document, const Json& json, const std::string& who,
                 std::span<std::uint8_t> buffer) {
  const CompressedView view = compressed_view(document, json, who);
  const auto offset = json.value("byteOffset", std::uint64_t{0});
  const auto length = json["byteLength"].get<std::uint64_t>();
  if (!has_valid_stride(view))
    fail(document.file, "{} has {} compressed elements of {} bytes ({}, {}), which cannot be", who,
         grouped(view.count), view.stride, view.mode, view.filter);
  if (length % view.stride != 0 || length / view.stride != view.count)
    fail(document.file, "{} has {} bytes, but {} compressed elements of {}", who, grouped(length),
         grouped(view.count), view.stride);
  ElementCheck(document.file).range(who, offset + length, buffer.size(), "its buffer");
  if (!decode(view, &buffer[offset]))
    fail(document.file, "{} has compressed data that are damaged, or of a later version of {}", who,
         extension::kMeshopt);
}

/// Refuses more bytes than the scene's could be decompressed to, before they take memory.
void count_fallbacks(Document& document, const FallbackBuffers& fallbacks) {
  const std::uint64_t read = document.bytes;
  for (const auto& [index, length] : fallbacks) {
    count_scene_bytes(document, length, fmt::format("{}: buffer {}", document.file, index));
    if (document.bytes - read > kMaxRatio * read)
      fail(document.file, "buffer {} has {} bytes without their data, the scene {}", index,
           grouped(length), grouped(read));
  }
}

}  // namespace

bool is_fallback_buffer(const Json& buffer) {
  const auto extensions = buffer.find("extensions");
  return extensions != buffer.end() && extensions->contains(extension::kMeshopt);
}

void decode_compressed_views(Document& document, const Json& views,
                             const FallbackBuffers& fallbacks) {
  count_fallbacks(document, fallbacks);
  std::map<std::size_t, Bytes> filled;
  for (const auto& [index, length] : fallbacks) filled.emplace(index, Bytes(length));
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto found = filled.find(views[i]["buffer"].get<std::size_t>());
    if (found != filled.end())
      decode_view(document, views[i], fmt::format("bufferView {}", i), found->second);
  }
  for (auto& [index, bytes] : filled) {
    document.storage.push_back(std::move(bytes));
    document.buffers[index] = document.storage.back();
  }
}

}  // namespace dapple::gltf
