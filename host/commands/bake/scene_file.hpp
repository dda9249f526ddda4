// The file that a bake adds values to: the scene's own, or a temporary one of a procedural scene.
// In: what the user typed. Out: a path.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// A procedural scene is written as a GLB file beside the output, and removed with this.
class SceneFile {
 public:
  /// Throws Error usage for a procedural scene that there is not, failed if it cannot be written.
  SceneFile(const std::string& spec, const std::string& output);
  ~SceneFile();
  SceneFile(const SceneFile&) = delete;
  SceneFile& operator=(const SceneFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Those of a procedural scene: a GLB file has no sky.
  [[nodiscard]] const std::vector<Light>& lights() const { return lights_; }

 private:
  void write(const Scene& scene, const std::filesystem::path& folder);
  void remove();

  std::string path_;
  std::vector<Light> lights_;
  bool is_made_ = false;
  int lock_ = -1;  ///< descriptor of the file that was made
};

}  // namespace dapple
