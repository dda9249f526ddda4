// Kernel text. Each included file is inserted once, with #line directives that name the original
// file and line, so that compiler messages name them too.
#include "device/programs/kernel_source.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "dapple/error.hpp"
#include "device/context.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

class KernelSource : public FilmFile {};

int count(const std::string& text, const std::string& what) {
  int found = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

/// File and line, according to the #line directives, of the first line that contains `what`.
std::string location_of(const std::string& text, const std::string& what) {
  std::istringstream lines(text);
  std::string line, file;
  int number = 0;
  while (std::getline(lines, line)) {
    if (line.rfind("#line ", 0) == 0) {
      std::istringstream directive(line.substr(6));
      directive >> number >> file;
      continue;
    }
    if (line.find(what) != std::string::npos) return file + ":" + std::to_string(number);
    ++number;
  }
  return "nowhere";
}

TEST_F(KernelSource, IncludesAreExpandedOnceWithTheLinesOfTheirFiles) {
  write_bytes(
      path("main.cl"),
      "// first\n#include \"a.clh\"\n#include \"b.clh\"\nin_main;\n#include \"a.clh\"\nlast;\n");
  write_bytes(path("a.clh"), "in_a;\n#include \"b.clh\"\nafter_b;\n");
  write_bytes(path("b.clh"), "\n\nin_b;");
  const std::string text = expand_kernel("main.cl", folder_.string());
  EXPECT_EQ(count(text, "#include"), 0);
  for (const char* once : {"in_a;", "in_b;", "after_b;", "in_main;", "last;"}) {
    EXPECT_EQ(count(text, once), 1) << once;
  }
  EXPECT_EQ(location_of(text, "// first"), "\"main.cl\":1");
  EXPECT_EQ(location_of(text, "in_a;"), "\"a.clh\":1");
  EXPECT_EQ(location_of(text, "in_b;"), "\"b.clh\":3");
  EXPECT_EQ(location_of(text, "after_b;"), "\"a.clh\":3");
  EXPECT_EQ(location_of(text, "in_main;"), "\"main.cl\":4");
  EXPECT_EQ(location_of(text, "last;"), "\"main.cl\":6");
}

TEST_F(KernelSource, EveryBuiltInKernelExpandsCompletely) {
  int kernels = 0;
  for (const EmbeddedSource& source : embedded_sources()) {
    const std::string text = expand_kernel(std::string(source.name));
    // Only #include <...> of standard headers remain, which the OpenCL compiler skips.
    EXPECT_EQ(count(text, "#include \""), 0) << source.name;
    kernels += source.name.ends_with(".cl");
  }
  EXPECT_GE(kernels, 6);
}

TEST_F(KernelSource, AKernelFolderReplacesBuiltInFilesOfTheSameName) {
  write_bytes(path("sampling/random.clh"), "replaced;\n");
  const std::string text = expand_kernel("occlusion/ao.cl", folder_.string());
  EXPECT_EQ(count(text, "replaced;"), 1);
  EXPECT_EQ(count(text, "make_frame(float3 n"), 1) << "direction.clh is not from the binary";
}

TEST_F(KernelSource, AMissingFileIsNamed) {
  write_bytes(path("main.cl"), "#include \"nowhere.clh\"\n");
  const Error error = error_of([&] { expand_kernel("main.cl", folder_.string()); });
  EXPECT_EQ(error.kind(), ErrorKind::failed);
  EXPECT_NE(std::string(error.what()).find("nowhere.clh"), std::string::npos) << error.what();
}

TEST_F(KernelSource, CompilerMessagesNameTheFileAndLineAtFault) {
  write_bytes(path("broken.cl"),
              "#include \"geometry/scene.clh\"\n__kernel void broken(__global int* out) {\n"
              "  out[0] = no_such_thing;\n}\n");
  write_bytes(path("outer.cl"),
              "#include \"inner.clh\"\n__kernel void outer(__global int* out) { }\n");
  write_bytes(path("inner.clh"), "\ninline int inner(void) { return no_such_thing; }\n");
  DeviceContext context("", folder_.string());
  const auto message = [&](const std::string& name) {
    const Error error = error_of([&] { context.prepare({name, "", {}}); });
    EXPECT_EQ(error.kind(), ErrorKind::device);
    return std::string(error.what());
  };
  const std::string broken = message("broken"), inner = message("outer");
  EXPECT_NE(broken.find("no_such_thing"), std::string::npos) << broken;
  EXPECT_NE(inner.find("no_such_thing"), std::string::npos) << inner;
  if (context.info().platform == "NVIDIA CUDA") GTEST_SKIP() << "its compiler ignores #line";
  EXPECT_NE(broken.find("broken.cl:3"), std::string::npos) << broken;
  EXPECT_NE(inner.find("inner.clh:2"), std::string::npos) << inner;
}

TEST_F(KernelSource, AKernelThatTheFileLacksIsADeviceError) {
  write_bytes(path("empty.cl"), "__kernel void other(__global int* out) { out[0] = 1; }\n");
  DeviceContext context("", folder_.string());
  const Error error = error_of([&] { context.prepare({"empty", "", {}}); });
  EXPECT_EQ(error.kind(), ErrorKind::device);
  EXPECT_NE(std::string(error.what()).find("empty"), std::string::npos) << error.what();
}

}  // namespace
}  // namespace dapple
