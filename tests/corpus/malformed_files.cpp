// URIs of buffers that are outside of the scene's folder, missing, or not regular files; and scenes
// that are not regular files.
#include <sys/stat.h>

#include "corpus/corpus.hpp"

namespace dapple::test {
namespace {

namespace fs = std::filesystem;
using Prepare = std::function<void(const fs::path&)>;

std::string document_with_uri(const std::string& uri, std::size_t length = 36) {
  GltfBuilder builder = one_triangle();
  builder.doc["buffers"] = json::array({{{"uri", uri}, {"byteLength", length}}});
  return builder.doc.dump();
}

void add_uri(MalformedCases& cases, const char* name, const std::string& uri, const char* says,
             const Prepare& prepare = {}) {
  SceneFiles files = as_text(document_with_uri(uri));
  files.prepare = prepare;
  cases.push_back({std::string("file_") + name, files, says});
}

void make_fifo(const fs::path& path) { ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0); }

/// Writes a valid buffer beside the scene's folder, where the scene must not read it.
void write_outside(const fs::path& folder) {
  const Bytes bytes = one_triangle().bin;
  std::ofstream(folder.parent_path() / "outside.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

void add_outside(MalformedCases& cases) {
  const char* const says = "leads out of the scene's folder";
  add_uri(cases, "parent", "../outside.bin", says, write_outside);
  add_uri(cases, "parent_encoded", "%2e%2e/outside.bin", says, write_outside);
  add_uri(cases, "parent_slash_encoded", "..%2Foutside.bin", says, write_outside);
  add_uri(cases, "parent_by_detour", "a/../../outside.bin", says, write_outside);
  add_uri(cases, "absolute", "/etc/passwd", says);
  add_uri(cases, "absolute_encoded", "%2Fetc%2Fpasswd", says);
  add_uri(cases, "absolute_by_two_slashes", "//etc/passwd", says);
  add_uri(cases, "device", "/dev/zero", says);
  add_uri(cases, "standard_input", "/dev/stdin", says);
  add_uri(cases, "process", "/proc/self/environ", says);
  add_uri(cases, "link_out", "link.bin", says, [](const fs::path& folder) {
    write_outside(folder);
    fs::create_symlink("../outside.bin", folder / "link.bin");
  });
  add_uri(cases, "folder_link_out", "link/passwd", says,
          [](const fs::path& folder) { fs::create_symlink("/etc", folder / "link"); });
  add_uri(cases, "link_to_a_device", "link.bin", says,
          [](const fs::path& folder) { fs::create_symlink("/dev/zero", folder / "link.bin"); });
}

void add_schemes(MalformedCases& cases) {
  const char* const says = "is not a relative path";
  add_uri(cases, "http", "http://example.org/scene.bin", says);
  add_uri(cases, "https", "https://example.org/scene.bin", says);
  add_uri(cases, "file_scheme", "file:///etc/passwd", says);
  add_uri(cases, "ftp", "ftp://example.org/scene.bin", says);
  add_uri(cases, "drive_letter", "C:\\scene.bin", says);
}

void add_kinds(MalformedCases& cases) {
  add_uri(cases, "absent", "absent.bin", "buffer 0 (absent.bin): no such file");
  add_uri(cases, "empty_uri", "", "buffer 0: has an empty uri");
  add_uri(cases, "itself", ".", "is a folder");
  add_uri(cases, "folder", "folder", "is a folder",
          [](const fs::path& folder) { fs::create_directory(folder / "folder"); });
  add_uri(cases, "fifo", "fifo.bin", "is not a regular file",
          [](const fs::path& folder) { make_fifo(folder / "fifo.bin"); });
  add_uri(cases, "nul", "scene.bin%00.png", "holds a NUL character");
  add_uri(cases, "long_name", std::string(300, 'a'), "longer than a file's name can be");
  add_uri(
      cases, "long_path",
      [] {
        std::string path;
        for (int i = 0; i < 3000; ++i) path += "a/";
        return path;
      }(),
      "longer than a file's name can be");
  add_uri(cases, "megabyte_name", std::string(1000000, 'b'), "longer than a file's name can be");
  add_uri(cases, "dangling_link", "link.bin", "link.bin",
          [](const fs::path& folder) { fs::create_symlink("absent.bin", folder / "link.bin"); });
  add_uri(cases, "link_loop", "link.bin", "link.bin", [](const fs::path& folder) {
    fs::create_symlink("other.bin", folder / "link.bin");
    fs::create_symlink("link.bin", folder / "other.bin");
  });
  SceneFiles cut = as_gltf(one_triangle());
  cut.files["scene.bin"].resize(35);
  cases.push_back({"file_cut_buffer", cut, "buffer 0: is too short"});
  cut.files["scene.bin"].clear();
  cases.push_back({"file_empty_buffer", cut, "buffer 0: is too short"});
  SceneFiles huge = as_text(document_with_uri("scene.bin", 9007199254740991));
  huge.files["scene.bin"] = one_triangle().bin;
  cases.push_back({"file_buffer_of_nine_petabytes", huge, "buffer 0"});
}

void add_data_uris(MalformedCases& cases) {
  add_uri(cases, "data_without_a_comma", "data:application/octet-stream;base64", "no comma");
  add_uri(cases, "data_of_bad_base64", "data:;base64,AA*A", "not base64");
  add_uri(cases, "data_of_a_lone_digit", "data:;base64,AAAAA", "cut off");
  add_uri(cases, "data_padded_in_the_middle", "data:;base64,AA==AAAA", "not base64");
  add_uri(cases, "data_too_short", "data:;base64,AAAA", "buffer 0: is too short");
  add_uri(cases, "data_empty", "data:application/octet-stream;base64,", "buffer 0: is too short");
  add_uri(cases, "data_of_an_image", "data:image/png;base64,AAAA",
          "its data: URI is \"image/png\"");
}

/// The scene itself is missing, too large or not a regular file.
void add_scenes(MalformedCases& cases) {
  const auto add = [&](const char* name, const char* says, const Prepare& prepare) {
    cases.push_back({std::string("scene_") + name, {"scene.glb", {}, prepare}, says});
  };
  add("absent", "scene.glb: no such file", [](const fs::path&) {});
  add("folder", "scene.glb: is a folder",
      [](const fs::path& folder) { fs::create_directory(folder / "scene.glb"); });
  add("fifo", "scene.glb: is not a regular file",
      [](const fs::path& folder) { make_fifo(folder / "scene.glb"); });
  add("device", "scene.glb: is not a regular file",
      [](const fs::path& folder) { fs::create_symlink("/dev/zero", folder / "scene.glb"); });
  add("link_loop", "scene.glb: cannot be read",
      [](const fs::path& folder) { fs::create_symlink("scene.glb", folder / "scene.glb"); });
  add("of_eight_gigabytes", "scene.glb: is too large", [](const fs::path& folder) {
    std::ofstream(folder / "scene.glb") << "glTF";
    fs::resize_file(folder / "scene.glb", std::uintmax_t{1} << 33);  // a sparse file
  });
}

}  // namespace

void add_malformed_files(MalformedCases& cases) {
  add_outside(cases);
  add_schemes(cases);
  add_kinds(cases);
  add_data_uris(cases);
  add_scenes(cases);
}

}  // namespace dapple::test
