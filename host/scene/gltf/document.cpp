// From a path to a Document: container, JSON, schema, buffers, tinygltf, validation.
#include "scene/gltf/document.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "scene/gltf/container.hpp"
#include "scene/gltf/message.hpp"
#include "scene/gltf/schema.hpp"
#include "scene/gltf/uri.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

constexpr int kMaxJsonDepth = 64;

/// A parsed document takes some 30 times its text: beyond this, buffers belong in files.
constexpr std::size_t kMaxJsonBytes = std::size_t{256} << 20;

Json parse_json(std::string_view text, const std::string& file) {
  if (text.size() > kMaxJsonBytes) {
    fail(file, "its JSON is too large ({} bytes, at most {}); keep buffers in .bin files or GLB",
         grouped(text.size()), grouped(kMaxJsonBytes));
  }
  check_json_depth(text, kMaxJsonDepth, file);
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    const std::string what = error.what();  // "[json.exception...] parse error at line 1, ..."
    const std::size_t bracket = what.find("] ");
    fail(file, "is not glTF: {}", bracket == std::string::npos ? what : what.substr(bracket + 2));
  }
}

void check_version(const Json& root, const std::string& file) {
  const Json& asset = root["asset"];
  const auto version = asset["version"].get<std::string>();
  if (!version.starts_with("2.")) fail(file, "is glTF {}; only 2.0 can be read", version);
  const auto minimum = asset.value("minVersion", std::string("2.0"));
  if (minimum != "2.0") fail(file, "needs glTF {}; only 2.0 can be read", minimum);
}

/// Takes an array out of the document, so that tinygltf neither copies nor opens it.
Json take(Json& root, const char* key) {
  const auto found = root.find(key);
  if (found == root.end()) return Json::array();
  Json taken = std::move(*found);
  root.erase(found);
  return taken;
}

/// What a buffer's uri or GLB's BIN chunk holds; `binary` is that chunk, if it is this
/// buffer's.
std::span<const std::uint8_t> buffer_bytes(Document& document, const Json& buffer,
                                           const std::string& what,
                                           std::optional<std::span<const std::uint8_t>> binary) {
  const std::uint64_t length = buffer["byteLength"].get<std::uint64_t>();
  if (!buffer.contains("uri")) return binary.value_or(std::span<const std::uint8_t>{});
  const auto& uri = buffer["uri"].get_ref<const std::string&>();
  document.storage.push_back(is_data_uri(uri)
                                 ? decode_data_uri(uri, what)
                                 : read_file(resolve_uri(document.folder, uri, what),
                                             fmt::format("{} ({})", what, uri), length));
  return document.storage.back();
}

bool is_compression_placeholder(const Json& buffer) {
  const auto extensions = buffer.find("extensions");
  return extensions != buffer.end() && (extensions->contains("EXT_meshopt_compression") ||
                                        extensions->contains("KHR_meshopt_compression"));
}

void load_buffers(Document& document, const Json& buffers,
                  std::optional<std::span<const std::uint8_t>> binary) {
  document.storage.reserve(document.storage.size() + buffers.size());
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const Json& buffer = buffers[i];
    const std::string what = fmt::format("{}: buffer {}", document.file, i);
    const std::uint64_t length = buffer["byteLength"].get<std::uint64_t>();
    const bool has_bytes = buffer.contains("uri") || (i == 0 && binary);
    if (!has_bytes && is_compression_placeholder(buffer)) {
      fail(what,
           "holds only EXT_meshopt_compression data, which dapple cannot read; export the "
           "scene uncompressed");
    }
    if (!has_bytes) fail(what, "has no uri, and the file has no binary chunk for it");
    const auto bytes = buffer_bytes(document, buffer, what, i == 0 ? binary : std::nullopt);
    if (bytes.size() < length) {
      fail(what, "is too short (byteLength is {}, it has {})", grouped(length),
           grouped(bytes.size()));
    }
    document.buffers.push_back(bytes.first(length));
  }
}

std::vector<ImageSource> image_sources(const Json& images) {
  std::vector<ImageSource> sources;
  sources.reserve(images.size());
  for (const Json& image : images) {
    sources.push_back({image.value("name", std::string()), image.value("uri", std::string()),
                       image.value("bufferView", -1)});
  }
  return sources;
}

/// Takes the primitives' `indices` out, in order: tinygltf refuses those whose accessor
/// has no bufferView, which glTF allows (zeros, replaced by sparse values).
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

void parse_model(Document& document, Json& root) {
  for (const char* unused : {"animations", "skins", "extras"}) root.erase(unused);
  const std::vector<int> indices = take_primitive_indices(root);
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

std::span<const std::uint8_t> view_bytes(const Document& document, int buffer_view) {
  const auto& view = document.model.bufferViews[static_cast<std::size_t>(buffer_view)];
  return document.buffers[static_cast<std::size_t>(view.buffer)].subspan(view.byteOffset,
                                                                         view.byteLength);
}

Document load_document(const std::string& path) {
  Document document;
  document.file = path;
  document.folder = std::filesystem::path(path).parent_path();
  document.storage.push_back(read_file(path, path));
  const Container container = split_container(document.storage.front(), path);
  Json root = parse_json(container.json, path);
  check_schema(root, path);
  check_version(root, path);
  check_extensions(root.value("extensionsRequired", std::vector<std::string>()), path);
  load_buffers(document, take(root, "buffers"), container.binary);
  document.images = image_sources(take(root, "images"));
  parse_model(document, root);
  validate(document);
  return document;
}

}  // namespace dapple::gltf
