// Compresses the bufferViews of a file that a test has built, as EXT_meshopt_compression says. In:
// a GltfBuilder; out: another, whose views are in a buffer without bytes.
#pragma once

#include <meshoptimizer.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";

inline Bytes encoded_attributes(const Bytes& elements, std::size_t count, std::size_t stride) {
  Bytes out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), elements.data(), count, stride));
  return out;
}

/// `triangles`: by the codec of triangles, which may begin them at other corners.
inline Bytes encoded_indices(const std::vector<unsigned>& indices, bool triangles) {
  Bytes out(meshopt_encodeIndexBufferBound(indices.size(), 1u << 20) + 5 * indices.size() + 64);
  std::size_t (*encode)(unsigned char*, std::size_t, const unsigned*, std::size_t) =
      meshopt_encodeIndexSequence;
  if (triangles) encode = meshopt_encodeIndexBuffer;
  out.resize(encode(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

/// Compressed views of one file, one by one.
class CompressedViews {
 public:
  CompressedViews() { out.doc["extensionsUsed"] = out.doc["extensionsRequired"] = {kMeshopt}; }

  /// Returns the index of the view of `size` bytes.
  int add(const Bytes& encoded, std::size_t count, std::size_t stride, const char* mode,
          const char* filter = "NONE") {
    while (out.bin.size() % 4 != 0) out.bin.push_back(0);
    const json compressed = {{"buffer", 0},          {"byteOffset", out.bin.size()},
                             {"byteStride", stride}, {"byteLength", encoded.size()},
                             {"count", count},       {"mode", mode},
                             {"filter", filter}};
    out.bin.insert(out.bin.end(), encoded.begin(), encoded.end());
    fallback_ = (fallback_ + 3) / 4 * 4;
    const int view = out.add("bufferViews", {{"buffer", 1},
                                             {"byteOffset", fallback_},
                                             {"byteLength", count * stride},
                                             {"extensions", {{kMeshopt, compressed}}}});
    fallback_ += count * stride;
    return view;
  }

  /// Copies a view as it is.
  int add_plain(const json& view, const Bytes& bytes) {
    const int index = out.add_view(bytes);
    for (const char* key : {"byteStride", "target"})
      if (view.contains(key)) out.doc["bufferViews"][index][key] = view[key];
    return index;
  }

  GltfBuilder finished() {
    out.doc["buffers"] = {
        {{"byteLength", out.bin.size()}},
        {{"byteLength", fallback_}, {"extensions", {{kMeshopt, {{"fallback", true}}}}}}};
    return out;
  }

  GltfBuilder out;

 private:
  std::size_t fallback_ = 0;
};

/// The index of the accessor that a view's bytes are, and whether they are indices of a primitive.
struct ViewUse {
  int accessor = -1;
  bool is_indices = false;
};

inline ViewUse use_of_view(const json& doc, int view) {
  ViewUse use;
  const json accessors = doc.value("accessors", json::array());
  for (std::size_t i = 0; i < accessors.size(); ++i)
    if (accessors[i].value("bufferView", -1) == view) use.accessor = static_cast<int>(i);
  for (const json& mesh : doc.value("meshes", json::array()))
    for (const json& primitive : mesh["primitives"])
      use.is_indices =
          use.is_indices || (use.accessor >= 0 && primitive.value("indices", -1) == use.accessor);
  return use;
}

/// All views that vertices or indices of 16 and 32 bits fill. Bits are those of `plain`, unless
/// triangles may begin at other corners.
inline GltfBuilder compressed(const GltfBuilder& plain, bool triangles = false) {
  CompressedViews views;
  views.out.doc = plain.doc;
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    views.out.doc[list].push_back(kMeshopt);
  const json old = plain.doc["bufferViews"];
  views.out.doc["bufferViews"] = json::array();
  for (std::size_t i = 0; i < old.size(); ++i) {
    const auto first = plain.bin.begin() + old[i]["byteOffset"].get<std::ptrdiff_t>();
    const Bytes bytes(first, first + old[i]["byteLength"].get<std::ptrdiff_t>());
    const ViewUse use = use_of_view(plain.doc, static_cast<int>(i));
    const std::size_t count =
        use.accessor < 0 ? 1 : plain.doc["accessors"][use.accessor]["count"].get<std::size_t>();
    const std::size_t stride = bytes.size() / count;
    if (use.accessor < 0 || stride * count != bytes.size() || stride % 2 != 0 ||
        (!use.is_indices && stride % 4 != 0)) {
      views.add_plain(old[i], bytes);
    } else if (use.is_indices) {
      std::vector<unsigned> indices(count);
      for (std::size_t k = 0; k < count; ++k) std::memcpy(&indices[k], &bytes[k * stride], stride);
      views.add(encoded_indices(indices, triangles), count, stride,
                triangles ? "TRIANGLES" : "INDICES");
    } else {
      const int view =
          views.add(encoded_attributes(bytes, count, stride), count, stride, "ATTRIBUTES");
      if (old[i].contains("byteStride"))
        views.out.doc["bufferViews"][view]["byteStride"] = old[i]["byteStride"];
    }
  }
  return views.finished();
}

}  // namespace dapple::test
