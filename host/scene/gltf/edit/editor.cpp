#include "scene/gltf/edit/editor.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include "files/output_file.hpp"
#include "scene/glb/glb_bytes.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/document/file_uris.hpp"
#include "scene/gltf/document/uri.hpp"
#include "scene/gltf/edit/compaction.hpp"
#include "scene/gltf/edit/extension_use.hpp"
#include "scene/images/media_type.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

namespace fs = std::filesystem;

void align(std::string& bytes, std::size_t multiple) {
  bytes.resize((bytes.size() + multiple - 1) / multiple * multiple, '\0');
}

template <class Range>
void append(std::string& bytes, const Range& range) {
  bytes.append(reinterpret_cast<const char*>(range.data()), range.size());
}

/// Whether a path of an extension leads to a file of the scene's folder. dapple reads none of them.
bool is_inside(const UriBase& base, const std::string& uri) {
  if (uri.empty() || has_scheme(uri) || percent_decode(uri).find("..") != std::string::npos)
    return false;
  try {
    resolve_uri({base.folder, false}, uri, uri);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

Editor::Editor(const SourceFile& source, std::string out)
    : source_(source), out_(std::move(out)), json_(source.content->json) {
  if (is_glb_out()) {
    if (has_binary() && has_no_buffer_files())
      start_from_binary();
    else
      embed_buffers();
    embed_images();
  } else if (has_binary()) {
    start_from_binary();
    json_["buffers"][0]["uri"] = percent_encode(side_name());
  } else {
    buffer_ = push("buffers", {{"uri", percent_encode(side_name())}});
  }
}

std::size_t Editor::push(const char* array, Json entry) {
  json_[array].push_back(std::move(entry));
  return json_[array].size() - 1;
}

std::size_t Editor::add_view(const std::string& bytes, std::size_t stride, int target) {
  align(bytes_, 4);
  Json view = {{"buffer", buffer_}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != 0) view["target"] = target;
  append(bytes_, bytes);
  return push("bufferViews", std::move(view));
}

std::size_t Editor::add_image(const std::string& png, const std::string& suffix) {
  if (is_glb_out())
    return push("images", {{"bufferView", add_view(png)}, {"mimeType", "image/png"}});
  const std::string path = image_path(suffix);
  new_images_.emplace_back(path, png);
  return push("images", {{"uri", percent_encode(fs::path(path).filename().string())}});
}

void Editor::write(PendingFiles& files) {
  if (is_glb_out()) drop_unused(content().json, json_, bytes_);
  if (bytes_.empty())
    remove_buffer();  // a buffer has at least one byte
  else
    json_["buffers"][buffer_]["byteLength"] = bytes_.size();
  const std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (is_glb_out()) {
    align(bytes_, 4);
    const std::string_view binary = bytes_;
    copy_side_files();
    write_glb_bytes(files.add(out_), text, {&binary, 1}, content().container.others);
    return;
  }
  for (const auto& [path, bytes] : new_images_) files.add(path, bytes);
  if (!bytes_.empty()) files.add((fs::path(out_).parent_path() / side_name()).string(), bytes_);
  copy_side_files();
  files.add(out_, text + "\n");
}

std::size_t Editor::lost_bytes() const {
  return is_glb_out() ? 0 : content().container.others.size();
}

// It is the last one, and nothing refers to it.
void Editor::remove_buffer() {
  Json& buffers = json_["buffers"];
  buffers.erase(buffer_);
  if (buffers.empty()) json_.erase("buffers");
}

std::vector<std::string> Editor::new_side_files() const {
  if (is_glb_out()) return {};
  return {(fs::path(out_).parent_path() / side_name()).string()};
}

bool Editor::is_glb_out() const { return fs::path(out_).extension() != ".gltf"; }

bool Editor::has_binary() const {
  const Json& json = content().json;
  return content().container.binary && json.contains("buffers") && !json["buffers"].empty() &&
         !json["buffers"][0].contains("uri");
}

// Whether the first buffer is the GLB's own, and none is in a file.
bool Editor::has_no_buffer_files() const {
  const auto is_file = [](const Json& buffer) { return buffer.contains("uri"); };
  return json_.contains("buffers") && !json_["buffers"].empty() &&
         std::none_of(json_["buffers"].begin(), json_["buffers"].end(), is_file);
}

std::string Editor::image_path(const std::string& suffix) const {
  return (fs::path(out_).parent_path() / free_name(suffix, ".png")).string();
}

std::string Editor::side_name() const {
  return has_binary() ? free_name("", ".bin") : free_name("_baked", ".bin");
}

// NAME`suffix``extension`, with a number if a file that the document names has it: an earlier
// bake's may have.
std::string Editor::free_name(const std::string& suffix, const std::string& extension) const {
  std::set<std::string> taken;
  for (const char* array : {"buffers", "images"})
    for (const Json& entry : content().json.value(array, Json::array()))
      if (const std::string uri = entry.value("uri", ""); !is_data_uri(uri))
        taken.insert(fs::path(percent_decode(uri)).lexically_normal().string());
  const std::string stem = fs::path(out_).stem().string() + suffix;
  std::string name = stem + extension;
  for (int number = 2; taken.contains(name); ++number)
    name = stem + "_" + std::to_string(number) + extension;
  return name;
}

void Editor::start_from_binary() {
  append(bytes_, *content().container.binary);
  buffer_ = 0;
}

// All buffers become the GLB's own, which has the first one's name and extras. So do those that
// compressed views fill: what these hold stays decompressed.
void Editor::embed_buffers() {
  std::set<std::size_t> used;  // without those of which only compressed data were used
  for (const Json& view : json_.value("bufferViews", Json::array()))
    used.insert(view["buffer"].get<std::size_t>());
  std::vector<std::size_t> begin;
  const auto& buffers = content().document.buffers;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    align(bytes_, 8);
    begin.push_back(bytes_.size());
    if (used.contains(i)) append(bytes_, buffers[i]);
  }
  if (json_.contains("bufferViews")) {
    for (Json& view : json_["bufferViews"]) {
      remove_extension(view, extension::kMeshopt);
      if (view.contains("extensions") && !view["extensions"].empty())
        fail(content().document.file,
             "has bufferViews with extensions, which cannot be embedded; write a .gltf file");
      view["byteOffset"] =
          begin.at(view["buffer"].get<std::size_t>()) + view.value("byteOffset", std::size_t{0});
      view["buffer"] = 0;
    }
  }
  Json first =
      json_.contains("buffers") && !json_["buffers"].empty() ? json_["buffers"][0] : Json::object();
  first.erase("uri");
  remove_extension(first, extension::kMeshopt);
  json_["buffers"] = Json::array({std::move(first)});
  unlist_unused_extension(json_, extension::kMeshopt);
  buffer_ = 0;
}

// Images in files of their own become bufferViews.
void Editor::embed_images() {
  if (!json_.contains("images")) return;
  for (Json& image : json_["images"]) {
    if (!image.contains("uri")) continue;
    const auto uri = image["uri"].get<std::string>();
    if (is_data_uri(uri)) continue;
    const fs::path path = resolve_uri(content().document.base, uri, "image " + uri);
    if (!fs::exists(path)) continue;  // dapple may not need it: the reference stays as it is
    const Bytes file = read_regular_file(path, "image " + uri);
    image.erase("uri");
    if (!image.contains("mimeType")) image["mimeType"] = image_media_type(file, path.string());
    image["bufferView"] = add_view({file.begin(), file.end()});
  }
}

// Files that the document names, to the output's folder.
void Editor::copy_side_files() const {
  for (const auto& [from, to] : side_copies()) {
    const Bytes bytes = read_regular_file(from, from);
    if (!fs::path(to).parent_path().empty()) fs::create_directories(fs::path(to).parent_path());
    write_whole_file(to,
                     std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
}

std::vector<std::pair<std::string, std::string>> Editor::side_copies() const {
  std::vector<std::string> uris;
  for (const char* array : {"buffers", "images"})
    for (const Json& entry : content().json.value(array, Json::array()))
      if (!is_glb_out() && entry.contains("uri")) uris.push_back(entry["uri"].get<std::string>());
  for_each_uri(content().json, [&](const std::string& uri, bool of_extension) {
    if (of_extension && is_inside(content().document.base, uri)) uris.push_back(uri);
  });
  const fs::path folder = fs::path(out_).parent_path();
  std::vector<std::pair<std::string, std::string>> files;
  for (const std::string& uri : uris) {
    if (is_data_uri(uri)) continue;
    const fs::path from = resolve_uri(content().document.base, uri, uri);
    const fs::path to = folder / percent_decode(uri);
    std::error_code ignored;
    if (fs::is_regular_file(from, ignored) && !fs::equivalent(from, to, ignored))
      files.emplace_back(from.string(), to.string());
  }
  return files;
}

}  // namespace dapple::gltf
