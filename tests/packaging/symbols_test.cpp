// What libdapple.so exports: all that the public headers declare, and nothing else. In: the symbols
// of the shared and of the static library, as nm lists them.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <regex>
#include <set>
#include <string>

#include "support/files/film_files.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

/// Demangled names of the global functions and objects that a library defines.
std::set<std::string> symbols_of(const std::string& path, const std::string& options) {
  const std::string command = "nm --demangle --defined-only " + options + " '" + path + "'";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::set<std::string> found;
  std::string line;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    // "0000000000001234 T name@@VERSION"; A is the version itself, W an inline function.
    if (line.size() > 19 && line[17] != 'A' && line[17] != 'W')
      found.insert(line.substr(19, line.find("@@") - 19));
    line.clear();
  }
  return found;
}

/// "render" of "dapple::render(...)", "Device::info" of "dapple::Device::info() const", "name_of"
/// of "dapple::name_of[abi:cxx11](...)"; empty for what is not a function of namespace dapple.
std::string function_name(const std::string& symbol) {
  static const std::regex pattern(
      "dapple::((?:\\w+::)*(?:operator=|[~\\w]+))(?:\\[abi:\\w+\\])?\\(.*");
  std::smatch match;
  return std::regex_match(symbol, match, pattern) ? match[1].str() : "";
}

/// Comments taken out: they name functions, too.
std::string public_headers() {
  std::string text;
  for (const auto& entry : fs::directory_iterator(DAPPLE_SOURCE_FOLDER "/include/dapple"))
    if (entry.is_regular_file()) text += film_test::bytes_of(entry.path().string());
  return std::regex_replace(text, std::regex("//[^\n]*"), "");
}

/// Whether the headers declare a function of this name, in the class or struct if it is in one.
bool is_declared(const std::string& headers, const std::string& name) {
  const std::size_t colons = name.rfind("::");
  const std::string last = colons == std::string::npos ? name : name.substr(colons + 2);
  const std::string owner = colons == std::string::npos ? "" : name.substr(0, colons);
  const bool declares = std::regex_search(headers, std::regex("[ &]" + last + "\\("));
  const auto has = [&](const std::string& text) { return headers.find(text) != std::string::npos; };
  return declares &&
         (owner.empty() || has("class " + owner + " {") || has("struct " + owner + " {"));
}

TEST(SharedLibrary, ExportsOnlyWhatThePublicHeadersDeclare) {
  const std::string headers = public_headers();
  const std::set<std::string> exported = symbols_of(DAPPLE_SHARED_LIBRARY, "-D");
  EXPECT_GT(exported.size(), 50u);
  for (const std::string& symbol : exported) {
    const std::string name = function_name(symbol);
    const bool is_error = symbol.ends_with(" for dapple::Error");
    EXPECT_TRUE(is_error || (!name.empty() && is_declared(headers, name)))
        << symbol << " is exported, but no public header declares it: host/libdapple.map";
  }
}

TEST(SharedLibrary, ExportsEveryFunctionOfThePublicHeaders) {
  const std::string headers = public_headers();
  const std::set<std::string> exported = symbols_of(DAPPLE_SHARED_LIBRARY, "-D");
  std::set<std::string> names;
  for (const std::string& symbol : exported) names.insert(function_name(symbol));
  for (const std::string& symbol : symbols_of(DAPPLE_STATIC_LIBRARY, "--extern-only")) {
    const std::string name = function_name(symbol);
    if (name.empty() || !is_declared(headers, name)) continue;
    EXPECT_TRUE(names.contains(name)) << symbol << " is not in host/libdapple.map";
  }
}

TEST(SharedLibrary, HasItsVersionInItsName) {
  const fs::path library(DAPPLE_SHARED_LIBRARY);  // libdapple.so.MAJOR.MINOR.PATCH
  const std::string name = library.filename().string();
  EXPECT_TRUE(std::regex_match(name, std::regex("libdapple\\.so\\.\\d+\\.\\d+\\.\\d+"))) << name;
  EXPECT_TRUE(fs::exists(library.parent_path() / name.substr(0, name.rfind('.'))));
}

}  // namespace
}  // namespace dapple
