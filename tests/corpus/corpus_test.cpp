// The library reads the corpus: it refuses malformed scenes with messages that name the file and
// the element, and reads from tricky scenes the triangles of their plain twins.
#include "corpus/corpus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace dapple::test {

namespace {

/// A folder inside a temporary folder, so that ".." is also a folder of this case only.
class CaseFolder {
 public:
  CaseFolder() { std::filesystem::create_directory(path()); }
  [[nodiscard]] std::filesystem::path path() const { return outer_.path("case"); }

 private:
  TempFolder outer_;
};

Scene read_and_merge(const std::string& path) {
  Scene scene = load_scene(path);
  merge_single_instances(scene);
  return scene;
}

/// Expects that all cases of a family are refused. One test covers a family, since a test for each
/// case would generate the corpus again for each of them.
void expect_refused(void (*add_family)(MalformedCases&)) {
  MalformedCases cases;
  add_family(cases);
  EXPECT_FALSE(cases.empty());
  for (const Malformed& malformed : cases) {
    SCOPED_TRACE(malformed.name);
    const CaseFolder folder;
    const std::string path = write_files(malformed.files, folder.path());
    const std::string message = input_error([&] { read_and_merge(path); });
    expect_says(message, malformed.says);
    expect_says(message, malformed.files.scene);
    EXPECT_LT(message.size(), 2000u);
  }
}

TEST(MalformedCorpus, ContainersAreRefusedByName) { expect_refused(add_malformed_containers); }
TEST(MalformedCorpus, JsonIsRefusedByName) { expect_refused(add_malformed_json); }
TEST(MalformedCorpus, WrongTypesAreRefusedByName) { expect_refused(add_wrong_types); }
TEST(MalformedCorpus, WrongValuesAreRefusedByName) { expect_refused(add_wrong_values); }
TEST(MalformedCorpus, WrongElementsAreRefusedByName) { expect_refused(add_wrong_elements); }
TEST(MalformedCorpus, WrongAccessorsAreRefusedByName) { expect_refused(add_wrong_accessors); }
TEST(MalformedCorpus, FilesAreRefusedByName) { expect_refused(add_malformed_files); }
TEST(MalformedCorpus, ImagesAreRefusedByName) { expect_refused(add_malformed_images); }
TEST(MalformedCorpus, MotionIsRefusedByName) { expect_refused(add_wrong_motion); }
TEST(MalformedCorpus, HairIsRefusedByName) { expect_refused(add_malformed_hair); }
TEST(MalformedCorpus, BombsAreRefusedByName) { expect_refused(add_bombs); }

std::vector<Triangle> sorted_triangles(const Scene& scene) {
  std::vector<Triangle> triangles = world_triangles(scene);
  const auto rounded = [](const V3f& p) {
    return std::array{std::lround(p.x * 64), std::lround(p.y * 64), std::lround(p.z * 64)};
  };
  for (Triangle& t : triangles) {
    std::sort(t.begin(), t.end(),
              [&](const V3f& a, const V3f& b) { return rounded(a) < rounded(b); });
  }
  std::sort(triangles.begin(), triangles.end(), [&](const Triangle& a, const Triangle& b) {
    return std::array{rounded(a[0]), rounded(a[1]), rounded(a[2])} <
           std::array{rounded(b[0]), rounded(b[1]), rounded(b[2])};
  });
  return triangles;
}

void expect_same_triangles(const Scene& given, const Scene& plain) {
  const auto triangles = sorted_triangles(given), expected = sorted_triangles(plain);
  ASSERT_EQ(triangles.size(), expected.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Quantized cases divide two metres into at least 100 steps.
      EXPECT_LT((triangles[i][k] - expected[i][k]).length(), 0.01f) << "triangle " << i;
    }
  }
}

void expect_twins(void (*add_family)(TrickyCases&)) {
  TrickyCases cases;
  add_family(cases);
  EXPECT_FALSE(cases.empty());
  for (const Tricky& tricky : cases) {
    SCOPED_TRACE(tricky.name);
    const CaseFolder folder, plain;
    expect_same_triangles(read_and_merge(write_files(tricky.files, folder.path())),
                          read_and_merge(write_files(tricky.plain, plain.path())));
  }
}

TEST(TrickyCorpus, GeometryHasTheTrianglesOfItsTwins) { expect_twins(add_tricky_geometry); }
TEST(TrickyCorpus, ScenesHaveTheTrianglesOfTheirTwins) { expect_twins(add_tricky_scenes); }
TEST(TrickyCorpus, MaterialsHaveTheTrianglesOfTheirTwins) { expect_twins(add_tricky_materials); }
TEST(TrickyCorpus, FilesHaveTheTrianglesOfTheirTwins) { expect_twins(add_tricky_files); }

TEST(Corpus, HasSomeFourHundredCasesOfDifferentNames) {
  std::set<std::string> names;
  const MalformedCases malformed = malformed_corpus();
  const TrickyCases tricky = tricky_corpus();
  for (const Malformed& one : malformed) EXPECT_TRUE(names.insert(one.name).second) << one.name;
  for (const Tricky& one : tricky) EXPECT_TRUE(names.insert(one.name).second) << one.name;
  EXPECT_GT(malformed.size(), 355u);
  EXPECT_GT(tricky.size(), 89u);
}

}  // namespace
}  // namespace dapple::test
