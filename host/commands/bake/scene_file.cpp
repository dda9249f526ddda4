#include "commands/bake/scene_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "commands/interruption.hpp"
#include "dapple/error.hpp"
#include "files/temporary_file.hpp"

namespace dapple {

namespace fs = std::filesystem;

SceneFile::SceneFile(const std::string& spec, const std::string& output) : path_(spec) {
  if (!spec.starts_with("scene:")) return;
  const Scene scene = make_procedural(spec);
  lights_ = scene.lights;
  write(scene, fs::path(output).parent_path());
}

SceneFile::~SceneFile() {
  if (is_made_) remove();
}

// The name is reserved by an empty file, whose lock the finished one takes over: without a lock the
// file would be one of a run that was killed.
void SceneFile::write(const Scene& scene, const fs::path& folder) {
  const TemporaryFile reserved = create_temporary_file(folder.empty() ? "." : folder.string());
  if (reserved.descriptor < 0)
    throw Error(
        ErrorKind::failed,
        fmt::format("folder {}: {}", folder.empty() ? "." : folder.string(), std::strerror(errno)));
  path_ = reserved.path;
  is_made_ = true;
  lock_ = reserved.descriptor;
  remove_when_interrupted(path_);
  try {
    write_glb(scene, path_);
  } catch (...) {
    remove();
    throw;
  }
  lock_ = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (lock_ >= 0) flock(lock_, LOCK_EX | LOCK_NB);
  close(reserved.descriptor);
}

void SceneFile::remove() {
  std::error_code ignored;
  fs::remove(path_, ignored);
  remove_when_interrupted("");
  if (lock_ >= 0) close(lock_);
}

}  // namespace dapple
