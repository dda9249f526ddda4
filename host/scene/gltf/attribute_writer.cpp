#include "scene/gltf/attribute_writer.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "scene/glb_bytes.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/container.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/vertices.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126, kUnsignedShort = 5123, kArrayBuffer = 34962;

bool is_glb_name(const std::string& path) { return fs::path(path).extension() != ".gltf"; }

const char* type_of(std::uint32_t components) {
  constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return kTypes[components - 1];
}

void align(std::string& bytes, std::size_t multiple) {
  bytes.resize((bytes.size() + multiple - 1) / multiple * multiple, '\0');
}

void append(std::string& bytes, const void* data, std::size_t count) {
  bytes.append(static_cast<const char*>(data), count);
}

std::uint16_t normalized16(float value) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 65535.0f));
}

/// Values as bytes; elements begin at multiples of four bytes. Returns the stride.
std::size_t store(const NewAttribute& attribute, std::string& bytes) {
  if (attribute.storage == Storage::float32) {
    append(bytes, attribute.values.data(), attribute.values.size() * sizeof(float));
    return attribute.components * sizeof(float);
  }
  const std::size_t stride = (2 * attribute.components + 3) / 4 * 4;
  for (std::size_t i = 0; i < attribute.values.size(); i += attribute.components) {
    for (std::size_t c = 0; c < attribute.components; ++c) {
      const std::uint16_t value = normalized16(attribute.values[i + c]);
      append(bytes, &value, sizeof value);
    }
    bytes.append(stride - 2 * attribute.components, '\0');
  }
  return stride;
}

/// Adds an entry to an array of the document. Returns its index.
std::size_t push(Json& json, const char* array, Json entry) {
  json[array].push_back(std::move(entry));
  return json[array].size() - 1;
}

}  // namespace

struct SourceFile::Content {
  Bytes bytes;
  Container container;
  Document document;
  Json json;

  [[nodiscard]] const tinygltf::Primitive& primitive(std::uint32_t mesh,
                                                     std::uint32_t index) const {
    return document.model.meshes[mesh].primitives[index];
  }
};

SourceFile::SourceFile(const std::string& path, bool allow_outside)
    : content(new Content{read_file(path, path), {}, load_document(path, allow_outside), {}}) {
  content->container = split_container(content->bytes, path);
  content->json = Json::parse(content->container.json);
}
SourceFile::~SourceFile() { delete content; }
SourceFile::SourceFile(SourceFile&& other) noexcept
    : content(std::exchange(other.content, nullptr)) {}

std::size_t SourceFile::vertex_count(std::uint32_t mesh, std::uint32_t primitive) const {
  const int positions = attribute(content->primitive(mesh, primitive), "POSITION");
  return content->document.model.accessors[static_cast<std::size_t>(positions)].count;
}

std::uint64_t SourceFile::vertex_key(std::uint32_t mesh, std::uint32_t primitive,
                                     const std::string& name) const {
  const auto& p = content->primitive(mesh, primitive);
  const auto positions = static_cast<std::uint64_t>(attribute(p, "POSITION"));
  return positions << 32 | static_cast<std::uint32_t>(attribute(p, name) + 1);
}

PrimitiveColors SourceFile::colors(std::uint32_t mesh, std::uint32_t primitive) const {
  const int accessor = attribute(content->primitive(mesh, primitive), "COLOR_0");
  if (accessor < 0) return {};
  const AccessorReader reader(content->document, accessor);
  PrimitiveColors colors{static_cast<std::uint32_t>(reader.components()), {}};
  colors.values.resize(4 * reader.count(), 1.0f);
  for (std::size_t i = 0; i < reader.count(); ++i)
    for (std::uint32_t c = 0; c < colors.components; ++c)
      colors.values[4 * i + c] = reader.normalized(i, c);
  return colors;
}

namespace {

/// Edits a copy of the document; new bytes come at the end of one of its buffers.
class Editor {
 public:
  Editor(const SourceFile& source, const std::string& out)
      : source_(source), out_(out), json_(source.content->json) {
    if (is_glb_name(out)) {
      keeps_binary_ = has_binary() && only_buffer_is_embedded();
      if (keeps_binary_)
        start_from_binary();
      else
        embed_buffers();
      if (!is_glb()) embed_images();
    } else if (has_binary()) {
      start_from_binary();
      json_["buffers"][0]["uri"] = side_name();
    } else {
      buffer_ = push(json_, "buffers", {{"uri", side_name()}});
    }
  }

  void add(const NewAttribute& attribute) {
    const std::uint64_t key =
        source_.vertex_key(attribute.mesh, attribute.primitive, attribute.name);
    const auto known = stored_.find({key, attribute.name});
    const std::size_t accessor =
        known != stored_.end() ? known->second : add_accessor(attribute, kArrayBuffer);
    stored_[{key, attribute.name}] = accessor;
    json_["meshes"][attribute.mesh]["primitives"][attribute.primitive]["attributes"]
         [attribute.name] = accessor;
  }

  void add(const NodeValues& values) {
    Json& node = json_["nodes"][values.node];
    const bool many =
        node.contains("extensions") && node["extensions"].contains("EXT_mesh_gpu_instancing");
    if (many) {
      NewAttribute attribute;
      attribute.values = values.values;
      node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["_AO"] =
          add_accessor(attribute, 0);
    } else if (!node.contains("extras") || node["extras"].is_object()) {
      node["extras"]["ao"] = values.values.at(0);
    }
  }

  void write() {
    json_["buffers"][buffer_]["byteLength"] = bytes_.size();
    const std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (is_glb_name(out_)) {
      align(bytes_, 4);
      const std::string_view binary = bytes_;
      write_glb_bytes(out_, text, {&binary, 1});
      return;
    }
    const fs::path folder = fs::path(out_).parent_path();
    copy_side_files(folder);
    write_whole_file((folder / side_name()).string(), bytes_);
    write_whole_file(out_, text + "\n");
  }

 private:
  [[nodiscard]] const SourceFile::Content& content() const { return *source_.content; }
  [[nodiscard]] bool has_binary() const { return content().container.binary.has_value(); }
  [[nodiscard]] bool is_glb() const {
    return content().bytes.size() >= 4 && content().bytes[0] == 'g' && content().bytes[1] == 'l';
  }
  /// Whether the first buffer is the GLB's own.
  [[nodiscard]] bool only_buffer_is_embedded() const {
    return json_.contains("buffers") && !json_["buffers"].empty() &&
           !json_["buffers"][0].contains("uri");
  }
  [[nodiscard]] std::string side_name() const {
    return fs::path(out_).stem().string() + (has_binary() ? ".bin" : "_baked.bin");
  }

  void start_from_binary() {
    const auto binary = *content().container.binary;
    append(bytes_, binary.data(), binary.size());
    buffer_ = 0;
  }

  /// All buffers become the GLB's own.
  void embed_buffers() {
    std::vector<std::size_t> begin;
    for (const auto& buffer : content().document.buffers) {
      align(bytes_, 8);
      begin.push_back(bytes_.size());
      append(bytes_, buffer.data(), buffer.size());
    }
    if (json_.contains("bufferViews")) {
      for (Json& view : json_["bufferViews"]) {
        if (view.contains("extensions") && !view["extensions"].empty())
          fail(content().document.file,
               "has bufferViews with extensions, which cannot be embedded; write a .gltf file");
        view["byteOffset"] =
            begin.at(view["buffer"].get<std::size_t>()) + view.value("byteOffset", std::size_t{0});
        view["buffer"] = 0;
      }
    }
    json_["buffers"] = Json::array({Json::object()});
    buffer_ = 0;
  }

  /// Images in files of their own become bufferViews.
  void embed_images() {
    if (!json_.contains("images")) return;
    for (Json& image : json_["images"]) {
      if (!image.contains("uri")) continue;
      const auto uri = image["uri"].get<std::string>();
      if (is_data_uri(uri)) continue;
      const fs::path path = resolve_uri(content().document.base, uri, "image " + uri);
      if (!fs::exists(path)) continue;  // dapple may not need it: the reference stays as it is
      const Bytes file = read_file(path, "image " + uri);
      align(bytes_, 8);
      image.erase("uri");
      if (!image.contains("mimeType"))
        image["mimeType"] = file.size() > 1 && file[0] == 0xff ? "image/jpeg" : "image/png";
      image["bufferView"] =
          push(json_, "bufferViews",
               {{"buffer", buffer_}, {"byteOffset", bytes_.size()}, {"byteLength", file.size()}});
      append(bytes_, file.data(), file.size());
    }
  }

  std::size_t add_accessor(const NewAttribute& attribute, int target) {
    align(bytes_, 4);
    const std::size_t begin = bytes_.size();
    const std::size_t stride = store(attribute, bytes_);
    Json view = {{"buffer", buffer_}, {"byteOffset", begin}, {"byteLength", bytes_.size() - begin}};
    if (target != 0) {
      view["byteStride"] = stride;
      view["target"] = target;
    }
    const bool whole = attribute.storage == Storage::normalized16;
    Json accessor = {{"bufferView", push(json_, "bufferViews", std::move(view))},
                     {"componentType", whole ? kUnsignedShort : kFloat},
                     {"count", attribute.values.size() / attribute.components},
                     {"type", type_of(attribute.components)}};
    if (whole) accessor["normalized"] = true;
    return push(json_, "accessors", std::move(accessor));
  }

  /// Files that the document names, to the output's folder.
  void copy_side_files(const fs::path& folder) const {
    for (const auto& [from, to] : side_files(folder)) {
      const Bytes bytes = read_file(from, from);
      if (!fs::path(to).parent_path().empty()) fs::create_directories(fs::path(to).parent_path());
      write_whole_file(to,
                       std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    }
  }

  /// From where to where; none that are in place.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> side_files(
      const fs::path& folder) const {
    std::vector<std::pair<std::string, std::string>> files;
    for (const char* array : {"buffers", "images"}) {
      const Json& source = content().json;
      if (!source.contains(array)) continue;
      for (const Json& entry : source[array]) {
        if (!entry.contains("uri")) continue;
        const auto uri = entry["uri"].get<std::string>();
        if (is_data_uri(uri)) continue;
        const fs::path from = resolve_uri(content().document.base, uri, uri);
        const fs::path to = folder / percent_decode(uri);
        std::error_code ignored;
        if (fs::exists(from) && !fs::equivalent(from, to, ignored))
          files.emplace_back(from.string(), to.string());
      }
    }
    return files;
  }

  friend std::vector<std::string> dapple::gltf::side_files_of(const SourceFile&,
                                                              const std::string&);

  const SourceFile& source_;
  const std::string& out_;
  Json json_;
  std::string bytes_;
  std::size_t buffer_ = 0;
  bool keeps_binary_ = false;
  std::map<std::pair<std::uint64_t, std::string>, std::size_t> stored_;
};

}  // namespace

void write_with_values(const SourceFile& source, const std::string& out,
                       const std::vector<NewAttribute>& attributes,
                       const std::vector<NodeValues>& nodes) {
  Editor editor(source, out);
  for (const NewAttribute& attribute : attributes) editor.add(attribute);
  for (const NodeValues& values : nodes) editor.add(values);
  editor.write();
}

std::vector<std::string> side_files_of(const SourceFile& source, const std::string& out) {
  if (is_glb_name(out)) return {};
  const Editor editor(source, out);
  const fs::path folder = fs::path(out).parent_path();
  std::vector<std::string> files{(folder / editor.side_name()).string()};
  for (const auto& [from, to] : editor.side_files(folder)) files.push_back(to);
  return files;
}

}  // namespace dapple::gltf
