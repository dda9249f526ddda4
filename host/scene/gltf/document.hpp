// A parsed and checked glTF document: tinygltf's model for all that is JSON, our own
// views of the buffers, our own list of images. In comes a path; out comes a value in
// which every index and every byte range holds.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf/file.hpp"
#include "scene/gltf/motion.hpp"
#include "scene/gltf/tinygltf.hpp"
#include "scene/gltf/uri.hpp"

namespace dapple::gltf {

/// Where an image's file is; nothing is read until somebody needs it.
struct ImageSource {
  std::string name;
  std::string uri;  ///< relative or data:, empty when in a bufferView
  int buffer_view = -1;
};

struct Document {
  std::string file;            ///< as given, for messages
  UriBase base;                ///< what URIs are relative to
  tinygltf::Model model;       ///< its buffers, images, skins and animations are empty
  std::vector<Bytes> storage;  ///< owns what `buffers` views
  std::vector<std::span<const std::uint8_t>> buffers;  ///< byteLength bytes each
  std::vector<ImageSource> images;
  Motion motion;
  std::vector<std::string> files;  ///< all of the scene's: itself, its buffers, its images
  std::uint64_t bytes = 0;         ///< of the JSON and of what `storage` owns
};

/// Reads, parses and validates. Throws Error input.
Document load_document(const std::string& path, bool allow_outside = false);

/// The bytes of a validated bufferView.
std::span<const std::uint8_t> view_bytes(const Document& document, int buffer_view);

/// How many morph targets a mesh has: as many as its primitive of the most.
std::uint64_t morph_target_count(const Document& document, int mesh);

/// Throws Error input when a required extension is not one that dapple reads or can
/// ignore without changing what occludes.
void check_extensions(const std::vector<std::string>& required, const std::string& file);

/// Throws Error input unless every index, bufferView, accessor, primitive and node is sound.
void validate(const Document& document);

}  // namespace dapple::gltf
