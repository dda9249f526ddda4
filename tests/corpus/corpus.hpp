// The corpus of bad and of unusual input: small glTF and HAIR files, made here, each in a folder of
// its own. Malformed ones must be refused by name, quickly and leaving nothing behind; tricky ones
// are valid, and must render like a plain twin.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "support/gltf_builder.hpp"

namespace dapple::test {

/// Files to be written, and the one among them that is the scene.
struct SceneFiles {
  std::string scene = "scene.glb";
  std::map<std::string, Bytes> files;
  /// What files cannot say: FIFOs, folders, links. Done in the folder, before the files.
  std::function<void(const std::filesystem::path&)> prepare;
};

/// Writes everything into `folder`, which exists, and returns the scene's path.
std::string write_files(const SceneFiles& files, const std::filesystem::path& folder);

struct Malformed {
  std::string name;  ///< letters, digits and underscores
  SceneFiles files;
  std::string says;  ///< part of the message, at least the element's name
};

struct Tricky {
  std::string name;
  SceneFiles files;
  SceneFiles plain;  ///< the twin
};

using MalformedCases = std::vector<Malformed>;
using TrickyCases = std::vector<Tricky>;

SceneFiles as_glb(const GltfBuilder& builder);
/// scene.gltf and its buffer as scene.bin.
SceneFiles as_gltf(const GltfBuilder& builder);
/// Text as scene.gltf.
SceneFiles as_text(const std::string& text);

// Families, a file each.
void add_malformed_containers(MalformedCases& cases);
void add_malformed_json(MalformedCases& cases);
void add_wrong_types(MalformedCases& cases);
void add_wrong_values(MalformedCases& cases);
void add_wrong_elements(MalformedCases& cases);
void add_wrong_accessors(MalformedCases& cases);
void add_malformed_files(MalformedCases& cases);
void add_malformed_images(MalformedCases& cases);
void add_wrong_motion(MalformedCases& cases);
void add_malformed_hair(MalformedCases& cases);
void add_bombs(MalformedCases& cases);
void add_tricky_geometry(TrickyCases& cases);
void add_tricky_scenes(TrickyCases& cases);
void add_tricky_materials(TrickyCases& cases);
void add_tricky_files(TrickyCases& cases);

MalformedCases malformed_corpus();
TrickyCases tricky_corpus();

}  // namespace dapple::test
