// Makes a Document from a path: container, JSON, schema, buffers and what they compress, tinygltf,
// validation.
#include "scene/gltf/document/document.hpp"

#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "scene/gltf/document/compressed_primitives.hpp"
#include "scene/gltf/document/compressed_views.hpp"
#include "scene/gltf/document/container.hpp"
#include "scene/gltf/document/element_check.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/document/json_text.hpp"
#include "scene/gltf/document/schema.hpp"
#include "scene/gltf/document/uri.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

/// The limit of all files of a scene together: a few bytes of JSON can name many of them.
constexpr std::uint64_t kMaxSceneBytes = FileKind{}.max_bytes;

/// Returns {2, 0} for "2.0"; none for text of another form.
std::optional<std::pair<int, int>> parse_version(const std::string& text) {
  std::pair<int, int> version;
  const char* const end = text.data() + text.size();
  const auto [dot, major_error] = std::from_chars(text.data(), end, version.first);
  if (major_error != std::errc{} || dot == end || *dot != '.') return {};
  const auto [stop, minor_error] = std::from_chars(dot + 1, end, version.second);
  if (minor_error != std::errc{} || stop != end) return {};
  return version;
}

void check_version(const Json& root, const std::string& file) {
  const Json& asset = root["asset"];
  const auto text = asset["version"].get<std::string>();
  const auto version = parse_version(text);
  if (!version || version->first != 2) {
    fail(file, "is glTF {}; only 2.0 can be read", excerpt(text));
  }
  const auto minimum = asset.value("minVersion", std::string("2.0"));
  if (minimum != "2.0") fail(file, "needs glTF {}; only 2.0 can be read", excerpt(minimum));
}

/// Removes an array from the document and returns it, so that tinygltf neither copies it nor opens
/// its files.
Json take(Json& root, const char* key) {
  const auto found = root.find(key);
  if (found == root.end()) return Json::array();
  Json taken = std::move(*found);
  root.erase(found);
  return taken;
}

/// Reads the bytes of buffers; buffers with the same file share what was read of it.
class BufferReader {
 public:
  explicit BufferReader(Document& document) : document_(document) {}

  /// Returns the bytes of the buffer's uri: at least `length`, or fewer if there are no more.
  std::span<const std::uint8_t> read(const std::string& uri, std::uint64_t length,
                                     const std::string& what) {
    if (is_data_uri(uri)) {
      check_media_type(uri, what);
      return keep(decode_data_uri(uri, what));
    }
    const std::string who = fmt::format("{} ({})", what, excerpt(uri));
    const std::string path = resolve_uri(document_.base, uri, what).string();
    const auto known = read_.find(path);
    if (known != read_.end() && known->second.size() >= length) return known->second;
    count_scene_bytes(document_, length, who);
    document_.files.push_back(path);
    return read_[path] = keep(read_regular_file(path, who, {}, length));
  }

 private:
  std::span<const std::uint8_t> keep(Bytes bytes) {
    document_.storage.push_back(std::move(bytes));
    return document_.storage.back();
  }

  /// glTF 2.0, section 3.6.1.1 allows two media types. Accepts every application type, and a
  /// missing type.
  static void check_media_type(const std::string& uri, const std::string& what) {
    const std::string_view type = data_media_type(uri);
    if (type.empty() || type.starts_with("application/")) return;
    fail(what, "its data: URI is \"{}\", not application/octet-stream", excerpt(type));
  }

  Document& document_;
  std::map<std::string, std::span<const std::uint8_t>> read_;
};

/// Reads all buffers that have bytes. Returns the others, which compressed bufferViews fill.
FallbackBuffers load_buffers(Document& document, const Json& buffers,
                             std::optional<std::span<const std::uint8_t>> binary) {
  BufferReader reader(document);
  FallbackBuffers fallbacks;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const Json& buffer = buffers[i];
    const std::string what = fmt::format("{}: buffer {}", document.file, i);
    const std::uint64_t length = buffer["byteLength"].get<std::uint64_t>();
    const bool has_uri = buffer.contains("uri");
    const bool has_bytes = has_uri || (i == 0 && binary);
    if (!has_bytes && is_fallback_buffer(buffer)) {
      fallbacks.emplace(i, length);
      document.buffers.emplace_back();
      continue;
    }
    if (!has_bytes && buffer.value("extensions", Json()).contains("KHR_meshopt_compression"))
      fail(what, "holds only KHR_meshopt_compression data; compress with EXT_meshopt_compression");
    if (!has_bytes) fail(what, "has no uri, and the file has no binary chunk for it");
    const auto bytes =
        has_uri ? reader.read(buffer["uri"].get_ref<const std::string&>(), length, what) : *binary;
    if (bytes.size() < length) {
      fail(what, "is too short (byteLength is {}, it has {})", grouped(length),
           grouped(bytes.size()));
    }
    document.buffers.push_back(bytes.first(length));
  }
  return fallbacks;
}

/// Lists where images are. Every uri is resolved, also of images that are not needed, so that a uri
/// that leads out of the folder is always an error.
void find_images(Document& document, const Json& images) {
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Json& image = images[i];
    const std::string what = fmt::format("{}: image {}", document.file, i);
    const bool has_uri = image.contains("uri");
    if (has_uri && image.contains("bufferView")) fail(what, "has both a uri and a bufferView");
    if (!has_uri && !image.contains("bufferView") && !image.contains("extensions")) {
      fail(what, "has neither a uri nor a bufferView");
    }
    document.images.push_back({image.value("name", std::string()),
                               image.value("uri", std::string()), image.value("bufferView", -1)});
    const std::string& uri = document.images.back().uri;
    if (!has_uri || is_data_uri(uri)) continue;
    if (document.base.allow_outside && has_scheme(uri)) continue;  // an error when it is needed
    document.files.push_back(resolve_uri(document.base, uri, what).string());
  }
}

/// Removes the `indices` of all primitives and returns them in order. tinygltf refuses indices
/// whose accessor has no bufferView, which glTF allows (zeros that sparse values replace).
std::vector<int> take_primitive_indices(Json& root) {
  std::vector<int> indices;
  const auto meshes = root.find("meshes");
  if (meshes == root.end()) return indices;
  for (Json& mesh : *meshes) {
    for (Json& primitive : mesh["primitives"]) {
      indices.push_back(primitive.value("indices", -1));
      primitive.erase("indices");
    }
  }
  return indices;
}

void put_primitive_indices(tinygltf::Model& model, const std::vector<int>& indices) {
  auto next = indices.begin();
  for (tinygltf::Mesh& mesh : model.meshes) {
    for (tinygltf::Primitive& primitive : mesh.primitives) primitive.indices = *next++;
  }
}

/// The elements of an array of the root of a tree that is not checked yet.
const Json& elements(const Json& root, const char* key) {
  static const Json none = Json::array();
  return root.is_object() && root.contains(key) ? root[key] : none;
}

/// `extras` of all cameras, and of the nodes that place them, of a tree that is not checked yet.
void keep_extras_of_cameras(const Json& root, Document& document) {
  const auto extras = [](const Json& element) {
    return element.is_object() ? element.value("extras", Json()) : Json();
  };
  for (const Json& camera : elements(root, "cameras"))
    document.camera_extras.push_back(extras(camera));
  int index = 0;
  for (const Json& node : elements(root, "nodes")) {
    if (node.is_object() && node.contains("camera") && node.contains("extras"))
      document.camera_node_extras[index] = extras(node);
    ++index;
  }
}

/// tinygltf's message about it names no light.
void check_spots(const Json& root, const std::string& file) {
  const auto pointer =
      Json::json_pointer(std::string("/extensions/") + extension::kLights + "/lights");
  if (!root.contains(pointer)) return;
  std::size_t index = 0;
  for (const Json& light : root.at(pointer)) {
    if (light.value("type", "") == "spot" && !light.contains("spot"))
      fail(file, "{} is a spot without \"spot\": {{}}, its cone",
           element("light", index, light.value("name", "")));
    ++index;
  }
}

void parse_model(Document& document, Json& root) {
  for (const char* unused : {"animations", "skins", "extras"}) root.erase(unused);
  const std::vector<int> indices = take_primitive_indices(root);
  check_spots(root, document.file);
  const std::string text = root.dump();
  std::string error;
  std::string warning;
  tinygltf::TinyGLTF parser;
  const bool parsed = parser.LoadASCIIFromString(&document.model, &error, &warning, text.data(),
                                                 static_cast<unsigned>(text.size()), "");
  if (!parsed || !error.empty()) fail(document.file, "is not glTF: {}", error);
  put_primitive_indices(document.model, indices);
}

}  // namespace

void count_scene_bytes(Document& document, std::uint64_t bytes, const std::string& who) {
  document.bytes += bytes;
  if (document.bytes <= kMaxSceneBytes) return;
  fail(who, "brings the scene to {} bytes (at most {})", grouped(document.bytes),
       grouped(kMaxSceneBytes));
}

std::span<const std::uint8_t> view_bytes(const Document& document, int buffer_view) {
  const auto& view = document.model.bufferViews[static_cast<std::size_t>(buffer_view)];
  return document.buffers[static_cast<std::size_t>(view.buffer)].subspan(view.byteOffset,
                                                                         view.byteLength);
}

int webp_image(const tinygltf::Texture& texture) {
  const auto webp = texture.extensions.find(extension::kWebp);
  return webp == texture.extensions.end() || !webp->second.Has("source")
             ? -1
             : webp->second.Get("source").GetNumberAsInt();
}

Document load_document(const std::string& path, bool allow_outside) {
  Document document;
  document.file = path;
  document.base = {std::filesystem::path(path).parent_path(), allow_outside};
  document.files.push_back(path);
  document.storage.push_back(read_regular_file(path, path));
  document.bytes = document.storage.front().size();
  const Container container = split_container(document.storage.front(), path);
  if (container.json.starts_with("\xef\xbb\xbf"))
    document.notes.push_back("its JSON begins with a byte order mark, which glTF forbids");
  Json root = parse_json(container.json, path);
  keep_extras_of_cameras(root, document);
  check_schema(root, path);
  check_version(root, path);
  check_extensions(root.value("extensionsRequired", std::vector<std::string>()), path);
  document.motion = read_motion(root, path);
  if (root.contains("nodes")) check_transforms(root["nodes"], path);
  const FallbackBuffers fallbacks = load_buffers(document, take(root, "buffers"), container.binary);
  decode_compressed_views(document, elements(root, "bufferViews"), fallbacks);
  find_images(document, take(root, "images"));
  parse_model(document, root);
  decode_compressed_primitives(document);
  validate(document);
  return document;
}

}  // namespace dapple::gltf
