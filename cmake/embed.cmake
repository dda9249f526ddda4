# Writes a C++ file that defines dapple::embedded_sources() over the files in SOURCES, named by their
# paths below the folders in ROOTS, as byte arrays: raw string literals would hit compilers' length limits.
set(arrays "")
set(table "")
set(index 0)
foreach(source IN LISTS SOURCES)
  set(name ${source})
  foreach(root IN LISTS ROOTS)
    string(REPLACE "${root}/" "" name "${name}")
  endforeach()
  file(READ ${source} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND arrays "const char source_${index}[] = {${bytes}'\\0'};\n")
  string(APPEND table "    {\"${name}\", {source_${index}, sizeof source_${index} - 1}},\n")
  math(EXPR index "${index} + 1")
endforeach()
file(WRITE ${OUTPUT} "// Generated from kernels/ by cmake/embed.cmake.
#include \"device/programs/kernel_source.hpp\"

namespace {
${arrays}
const dapple::EmbeddedSource table[] = {
${table}};
}  // namespace

namespace dapple {
std::span<const EmbeddedSource> embedded_sources() { return table; }
}  // namespace dapple
")
