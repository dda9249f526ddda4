// Sources of kernels. In: the name of a file that is embedded at build time or read from a folder.
// Out: its text with every #include "..." expanded, so that no OpenCL compiler needs include
// folders.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace dapple {

/// A file below kernels/, or of include/dapple/shared/, by its path: "occlusion/packet.clh",
/// "dapple/shared/ray.h".
struct EmbeddedSource {
  std::string_view name;
  std::string_view text;
};

/// Defined in the file that cmake/embed.cmake generates.
std::span<const EmbeddedSource> embedded_sources();

/// The text of `file` with every quoted include replaced, once, by the file it names, and
/// #line directives so that diagnostics name real files. Files come from `kernel_dir` when
/// it is not empty and has them, else from the binary. Throws Error failed.
std::string expand_kernel(const std::string& file, const std::string& kernel_dir = "");

/// A checksum of all kernels' sources, as hexadecimal text.
std::string kernel_checksum(const std::string& kernel_dir);

}  // namespace dapple
