// The corpus, read by the library: what is malformed is refused by name, what is tricky has
// the triangles of its plain twin.
#include "corpus/corpus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <set>

namespace dapple::test {

/// Failures and lists of tests name a case instead of dumping its bytes.
void PrintTo(const Malformed& malformed, std::ostream* out) { *out << malformed.name; }
void PrintTo(const Tricky& tricky, std::ostream* out) { *out << tricky.name; }

namespace {

/// A folder in a folder, so that ".." is a place of the case's own.
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

class MalformedCorpus : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedCorpus, IsRefusedByName) {
  const CaseFolder folder;
  const std::string path = write_files(GetParam().files, folder.path());
  const std::string message = input_error([&] { read_and_merge(path); });
  expect_says(message, GetParam().says);
  expect_says(message, GetParam().files.scene);
  EXPECT_LT(message.size(), 2000u);
}

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

class TrickyCorpus : public testing::TestWithParam<Tricky> {};

TEST_P(TrickyCorpus, HasTheTrianglesOfItsPlainTwin) {
  if (GetParam().name == "masked_below_its_cutoff") GTEST_SKIP() << "hidden by its material";
  const CaseFolder folder, plain;
  const auto triangles =
      sorted_triangles(read_and_merge(write_files(GetParam().files, folder.path())));
  const auto expected =
      sorted_triangles(read_and_merge(write_files(GetParam().plain, plain.path())));
  ASSERT_EQ(triangles.size(), expected.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Quantization to 1/100 of two metres.
      EXPECT_LT((triangles[i][k] - expected[i][k]).length(), 0.01f) << "triangle " << i;
    }
  }
}

TEST(Corpus, HasSomeFourHundredCasesOfDifferentNames) {
  std::set<std::string> names;
  const MalformedCases malformed = malformed_corpus();
  const TrickyCases tricky = tricky_corpus();
  for (const Malformed& one : malformed) EXPECT_TRUE(names.insert(one.name).second) << one.name;
  for (const Tricky& one : tricky) EXPECT_TRUE(names.insert(one.name).second) << one.name;
  EXPECT_GT(malformed.size(), 355u);
  EXPECT_GT(tricky.size(), 89u);
}

INSTANTIATE_TEST_SUITE_P(Corpus, MalformedCorpus, testing::ValuesIn(malformed_corpus()),
                         [](const auto& instance) { return instance.param.name; });
INSTANTIATE_TEST_SUITE_P(Corpus, TrickyCorpus, testing::ValuesIn(tricky_corpus()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace dapple::test
