// The corpus of wrong and of unusual input: small glTF and HAIR files that the tests generate, each
// case in its own folder. Malformed cases must be refused soon, with a message that names the file
// and the element, and without leaving files. Tricky cases are valid: each must render like its
// plain twin, which holds the same scene in a simple form.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {

/// Files to write, and the name of the file that is the scene.
struct SceneFiles {
  std::string scene = "scene.glb";
  std::map<std::string, Bytes> files;
  /// Makes what is not a file (FIFOs, folders, links) in the folder. It runs before the files are
  /// written.
  std::function<void(const std::filesystem::path&)> prepare;
};

/// Writes everything into `folder`, which must exist, and returns the scene's path.
std::string write_files(const SceneFiles& files, const std::filesystem::path& folder);

struct Malformed {
  std::string name;  ///< letters, digits and underscores
  SceneFiles files;
  std::string says;  ///< part of the message that must occur, at least the element's name
};

struct Tricky {
  std::string name;
  SceneFiles files;
  SceneFiles plain;  ///< the plain twin
};

using MalformedCases = std::vector<Malformed>;
using TrickyCases = std::vector<Tricky>;

SceneFiles as_glb(const GltfBuilder& builder);
/// The builder's scene as scene.gltf, with its buffer in scene.bin.
SceneFiles as_gltf(const GltfBuilder& builder);
/// The text as scene.gltf.
SceneFiles as_text(const std::string& text);

// Each of these adds a family of cases, and is in a file of its own.
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
