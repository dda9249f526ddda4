// Only this file uses Draco: see draco_mesh.hpp.
#include "scene/gltf/document/draco_mesh.hpp"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>

#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

/// A mesh's tables of corners and of the order of vertices, with those of the decoder.
constexpr std::uint64_t kBytesOfTriangle = 96, kBytesOfVertex = 24;
/// The same once more for attributes with seams of their own.
constexpr std::uint64_t kBytesOfSeams = 56;
/// A component before and while it is predicted.
constexpr std::uint64_t kBytesOfComponent = 8;

/// More for one stream is refused, whatever its size.
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 34;

/// Reads numbers of a stream ahead of its decoder; 0 after its end, which the decoder will find.
class Preview {
 public:
  explicit Preview(const draco::DecoderBuffer& buffer) : buffer_(buffer) {}

  std::uint64_t number() {
    std::uint32_t value = 0;
    return draco::DecodeVarint(&value, &buffer_) ? value : 0;
  }
  std::uint64_t byte() {
    std::uint8_t value = 0;
    return buffer_.Decode(&value) ? value : 0;
  }

 private:
  draco::DecoderBuffer buffer_;
};

/// Bytes that the tables of a mesh take, whose connectivity is next in the stream (Draco bitstream
/// specification 2.2, DecodeSequentialConnectivityData and ParseEdgebreakerConnectivityData).
std::uint64_t bytes_of_connectivity(Preview stream, const draco::MeshSequentialDecoder&) {
  const std::uint64_t triangles = stream.number(), vertices = stream.number();
  return triangles * kBytesOfTriangle + vertices * kBytesOfVertex;
}

std::uint64_t bytes_of_connectivity(Preview stream, const draco::MeshEdgebreakerDecoder&) {
  const std::uint64_t vertices = stream.number(), triangles = stream.number();
  const std::uint64_t seams = stream.byte();
  stream.number();  // symbols
  const std::uint64_t splits = stream.number();
  return triangles * (kBytesOfTriangle + kBytesOfSeams * seams) +
         (vertices + splits) * kBytesOfVertex;
}

/// One of Draco's decoders that stops before it allocates more than `memory` has.
template <class Decoder>
class BoundedDecoder : public Decoder {
 public:
  explicit BoundedDecoder(DecodingMemory& memory) : memory_(memory) {}

  /// What was too much; 0: nothing was.
  [[nodiscard]] std::uint64_t refused_bytes() const { return refused_; }

 protected:
  bool DecodeConnectivity() override {
    return take(bytes_of_connectivity(Preview(*this->buffer()), *this)) &&
           Decoder::DecodeConnectivity();
  }

  /// The stream has named the attributes, whose values come next.
  bool DecodeAllAttributes() override {
    const draco::PointCloud& points = *this->point_cloud();
    std::uint64_t bytes = 0;
    for (int i = 0; i < points.num_attributes(); ++i) {
      const draco::PointAttribute& attribute = *points.attribute(i);
      const auto size = static_cast<std::uint64_t>(draco::DataTypeLength(attribute.data_type()));
      bytes += kBytesOfVertex + attribute.num_components() * (size + kBytesOfComponent);
    }
    return take(points.num_points() * bytes) && Decoder::DecodeAllAttributes();
  }

 private:
  bool take(std::uint64_t bytes) {
    taken_ += bytes;
    if (bytes > memory_.left || taken_ > kMaxBytes) {
      refused_ = taken_;
      return false;
    }
    memory_.left -= bytes;
    return true;
  }

  DecodingMemory& memory_;
  std::uint64_t taken_ = 0, refused_ = 0;
};

template <class Decoder>
std::unique_ptr<draco::Mesh> decoded(draco::DecoderBuffer buffer, DecodingMemory& memory,
                                     const StreamUser& user) {
  const auto size = static_cast<std::uint64_t>(buffer.remaining_size());
  const std::uint64_t left = memory.left;
  auto mesh = std::make_unique<draco::Mesh>();
  const draco::DecoderOptions options;
  BoundedDecoder<Decoder> decoder(memory);
  const draco::Status status = decoder.Decode(options, &buffer, mesh.get());
  if (decoder.refused_bytes() != 0)
    fail(user.file,
         "{}: its {} bytes of Draco data say that decoding them takes {} bytes (at most "
         "{})",
         user.who, grouped(size), grouped(decoder.refused_bytes()),
         grouped(std::min(left, kMaxBytes)));
  if (!status.ok())
    fail(user.file, "{} has Draco data that are damaged ({})", user.who,
         excerpt(status.error_msg_string()));
  return mesh;
}

std::unique_ptr<draco::Mesh> decode(std::span<const std::uint8_t> stream, DecodingMemory& memory,
                                    const StreamUser& user) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
  draco::DracoHeader header;
  draco::DecoderBuffer ahead = buffer;
  if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok())
    fail(user.file, "{} has data that do not begin as Draco's do", user.who);
  if (header.version_major != 2 || header.version_minor != 2)
    fail(user.file, "{} has Draco data of version {}.{}; 2.2 can be read", user.who,
         header.version_major, header.version_minor);
  if (header.encoder_type != draco::TRIANGULAR_MESH)
    fail(user.file, "{} has Draco data of points, not of a mesh", user.who);
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
    return decoded<draco::MeshSequentialDecoder>(buffer, memory, user);
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
    return decoded<draco::MeshEdgebreakerDecoder>(buffer, memory, user);
  fail(user.file, "{} has Draco data of an unknown method, {}", user.who, header.encoder_method);
}

/// Whether all vertices have a value of the attribute.
bool has_values(const draco::PointAttribute& attribute, std::uint32_t vertices) {
  for (draco::PointIndex i(0); i < vertices; ++i)
    if (attribute.mapped_index(i).value() >= attribute.size()) return false;
  return true;
}

/// As other readers of the extension convert values: integers that are normalized become floats in
/// [0,1] or [-1,1], others keep their value. Returns false if it does not fit.
template <class T>
bool convert(const draco::PointAttribute& attribute, std::uint32_t vertices,
             const ElementLayout& layout, Bytes& bytes) {
  std::vector<T> values(layout.components);
  const auto components = static_cast<std::int8_t>(layout.components);
  std::uint8_t* out = bytes.data();
  for (draco::PointIndex i(0); i < vertices; ++i, out += layout.stride) {
    if (!attribute.ConvertValue(attribute.mapped_index(i), components, values.data())) return false;
    for (std::size_t c = 0; c < values.size(); ++c)
      std::memcpy(out + layout.offset(c), &values[c], sizeof(T));
  }
  return true;
}

bool convert(const draco::PointAttribute& attribute, std::uint32_t vertices,
             const ElementLayout& layout, Component type, Bytes& bytes) {
  switch (type) {
    case Component::int8:
      return convert<std::int8_t>(attribute, vertices, layout, bytes);
    case Component::uint8:
      return convert<std::uint8_t>(attribute, vertices, layout, bytes);
    case Component::int16:
      return convert<std::int16_t>(attribute, vertices, layout, bytes);
    case Component::uint16:
      return convert<std::uint16_t>(attribute, vertices, layout, bytes);
    case Component::uint32:
      return convert<std::uint32_t>(attribute, vertices, layout, bytes);
    case Component::float32:
      return convert<float>(attribute, vertices, layout, bytes);
  }
  return false;
}

}  // namespace

DracoMesh::DracoMesh(std::span<const std::uint8_t> stream, DecodingMemory& memory,
                     const StreamUser& user)
    : mesh_(decode(stream, memory, user)) {
  if (mesh_->num_faces() == 0) fail(user.file, "{} has Draco data without triangles", user.who);
  for (draco::FaceIndex i(0); i < mesh_->num_faces(); ++i)
    for (const draco::PointIndex& corner : mesh_->face(i))
      if (corner.value() >= mesh_->num_points())
        fail(user.file, "{} has Draco data whose triangle {} names vertex {}, but there are {}",
             user.who, grouped(i.value()), grouped(corner.value()), grouped(mesh_->num_points()));
}

DracoMesh::~DracoMesh() = default;

std::uint64_t DracoMesh::vertex_count() const { return mesh_->num_points(); }

std::uint64_t DracoMesh::index_count() const { return std::uint64_t{3} * mesh_->num_faces(); }

std::vector<std::uint32_t> DracoMesh::indices() const {
  std::vector<std::uint32_t> indices;
  indices.reserve(index_count());
  for (draco::FaceIndex i(0); i < mesh_->num_faces(); ++i)
    for (const draco::PointIndex& corner : mesh_->face(i)) indices.push_back(corner.value());
  return indices;
}

Bytes DracoMesh::attribute(std::uint32_t id, const ElementLayout& layout, Component type,
                           const StreamUser& user) const {
  const draco::PointAttribute* found = mesh_->GetAttributeByUniqueId(id);
  if (found == nullptr)
    fail(user.file, "{} is attribute {} of Draco data, which lack it", user.who, id);
  if (found->num_components() != layout.components)
    fail(user.file, "{} has {} components in its accessor, but {} in its Draco data", user.who,
         layout.components, found->num_components());
  Bytes bytes(layout.stride * vertex_count());
  if (!has_values(*found, mesh_->num_points()) ||
      !convert(*found, mesh_->num_points(), layout, type, bytes))
    fail(user.file, "{} has Draco data with values that its accessor's type cannot hold", user.who);
  return bytes;
}

}  // namespace dapple::gltf
