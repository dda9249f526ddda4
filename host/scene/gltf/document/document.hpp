// A parsed and checked glTF document: tinygltf's model for the JSON, our own views of the buffers
// and our own list of images. In: a path; out: a Document in which every index and every byte range
// is valid.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf/document/motion.hpp"
#include "scene/gltf/document/tinygltf.hpp"
#include "scene/gltf/document/uri.hpp"
#include "scene/regular_file.hpp"

namespace dapple::gltf {

/// Where an image's bytes are; they are read only when a material needs them.
struct ImageSource {
  std::string name;
  std::string uri;  ///< relative or data:; empty when the bytes are in a bufferView
  int buffer_view = -1;
};

struct Document {
  std::string file;            ///< as given, for messages
  UriBase base;                ///< the folder that URIs are relative to
  tinygltf::Model model;       ///< its buffers, images, skins and animations are empty
  std::vector<Bytes> storage;  ///< owns the bytes that `buffers` refers to
  std::vector<std::span<const std::uint8_t>> buffers;  ///< byteLength bytes each
  std::vector<ImageSource> images;
  Motion motion;
  std::vector<nlohmann::json> camera_extras;         ///< by camera; null: none
  std::map<int, nlohmann::json> camera_node_extras;  ///< by node, of those that place a camera
  std::vector<std::string> files;  ///< paths of the scene file, its buffers and its images
  std::uint64_t bytes = 0;  ///< of the scene file, the buffers' files and what was decompressed
  std::vector<std::string> notes;  ///< what the file may not have, and is read nevertheless
};

/// Reads, parses and validates a file. With `allow_outside`, URIs may lead out of its folder.
/// Throws Error input.
Document load_document(const std::string& path, bool allow_outside = false);

/// Adds to document.bytes. Throws Error input, naming `who`, where a scene has too many.
void count_scene_bytes(Document& document, std::uint64_t bytes, const std::string& who);

/// Returns the bytes of a validated bufferView.
std::span<const std::uint8_t> view_bytes(const Document& document, int buffer_view);

/// Returns the image that EXT_texture_webp gives a texture, which stands in for its `source`; -1:
/// none.
int webp_image(const tinygltf::Texture& texture);

/// Returns the number of morph targets of a mesh: the maximum over its primitives.
std::uint64_t morph_target_count(const Document& document, int mesh);

/// Throws Error input when dapple does not read a required extension and cannot ignore it without
/// changing occlusion.
void check_extensions(const std::vector<std::string>& required, const std::string& file);

/// Throws Error input unless every index, bufferView, accessor, primitive and node is valid.
void validate(const Document& document);

}  // namespace dapple::gltf
