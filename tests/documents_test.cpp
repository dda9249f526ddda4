// The documents of the source tree: README has at most 200 lines, no paragraph has more than ten,
// and links lead to files that exist. Sources use the field's words. In: Markdown files and
// sources; out: one failure for each offence, with file and line.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace dapple {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot(DAPPLE_SOURCE_FOLDER);

std::vector<std::string> lines_of(const fs::path& path) {
  std::vector<std::string> lines;
  std::ifstream stream(path);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Files below `folder` (not in hidden or build folders) with one of these extensions.
std::vector<fs::path> files_below(const fs::path& folder, const std::vector<std::string>& endings) {
  std::vector<fs::path> files;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::end(it); ++it) {
    const std::string name = it->path().filename().string();
    if (it->is_directory() && (name.starts_with(".") || name == "build")) {
      it.disable_recursion_pending();
      continue;
    }
    for (const std::string& ending : endings)
      if (name.ends_with(ending)) files.push_back(it->path());
  }
  return files;
}

std::string position_of(const fs::path& path, std::size_t line) {
  return fs::relative(path, kRoot).generic_string() + ":" + std::to_string(line + 1);
}

/// The lines of a document outside of code blocks; lines inside are empty.
std::vector<std::string> prose_of(const fs::path& path) {
  std::vector<std::string> lines = lines_of(path);
  bool in_code = false;
  for (std::string& line : lines) {
    const bool fence = line.find("```") != std::string::npos;
    if (fence || in_code || line.starts_with("    ")) line.clear();
    if (fence) in_code = !in_code;
  }
  return lines;
}

TEST(Documents, ReadmeHasAtMostTwoHundredLines) {
  EXPECT_LE(lines_of(kRoot / "README.md").size(), 200u);
}

TEST(Documents, ParagraphsHaveAtMostTenLines) {
  static const std::regex item("\\s*([-*]|\\d+\\.) .*");
  for (const fs::path& path : files_below(kRoot, {".md"})) {
    const std::vector<std::string> lines = prose_of(path);
    int length = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string& line = lines[i];
      const bool outside = line.empty() || line.starts_with("|") || line.starts_with("#");
      length = outside ? 0 : std::regex_match(line, item) ? 1 : length + 1;
      EXPECT_LE(length, 10) << position_of(path, i);
    }
  }
}

TEST(Documents, LinksLeadToFiles) {
  static const std::regex link("\\]\\(([^)#]+)(#[^)]*)?\\)");
  int count = 0;
  for (const fs::path& path : files_below(kRoot, {".md"})) {
    const std::vector<std::string> lines = prose_of(path);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      for (std::sregex_iterator it(lines[i].begin(), lines[i].end(), link), end; it != end; ++it) {
        const std::string target = (*it)[1];
        if (target.starts_with("http")) continue;
        ++count;
        EXPECT_TRUE(fs::exists(path.parent_path() / target))
            << position_of(path, i) << ": " << target;
      }
    }
  }
  EXPECT_GT(count, 30);
}

TEST(Documents, PathsInContributingExist) {
  static const std::regex path_text("`((kernels|host|include|tests|docs|bench|python)/[a-z_/.]+)`");
  const std::vector<std::string> lines = lines_of(kRoot / "CONTRIBUTING.md");
  int count = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::sregex_iterator it(lines[i].begin(), lines[i].end(), path_text), end; it != end;
         ++it) {
      ++count;
      EXPECT_TRUE(fs::exists(kRoot / (*it)[1].str()))
          << "CONTRIBUTING.md:" << i + 1 << ": " << (*it)[1];
    }
  }
  EXPECT_GT(count, 10);
}

TEST(Documents, SourcesUseTheFieldsWords) {
  // Words that once had a private meaning here; no word of the field contains them.
  const std::vector<std::string> private_words{"scout",  "vanguard",   "rehears", "furnish",
                                               "deepen", "unevenness", "weighs",  "whom"};
  const std::vector<std::string> endings{".cpp", ".hpp", ".h", ".cl", ".clh", ".py", ".txt", ".md"};
  for (const char* folder : {"host", "kernels", "include", "python", "bench", "tests", "docs"}) {
    for (const fs::path& path : files_below(kRoot / folder, endings)) {
      if (path.filename() == "documents_test.cpp") continue;
      const std::vector<std::string> lines = lines_of(path);
      for (std::size_t i = 0; i < lines.size(); ++i)
        for (const std::string& word : private_words)
          EXPECT_EQ(lines[i].find(word), std::string::npos) << position_of(path, i) << ": " << word;
    }
  }
}

}  // namespace
}  // namespace dapple
