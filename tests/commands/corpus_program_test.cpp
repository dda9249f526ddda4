// The program renders the corpus. It refuses malformed scenes soon, with the exit code of bad
// input, a message of few lines, and without leaving files. Tricky scenes give the picture of their
// plain twins.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <thread>

#include "corpus/corpus.hpp"
#include "support/files/film_files.hpp"
#include "support/sanitizers.hpp"

namespace dapple::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxLines = 20;

struct Run {
  int code = -1;
  std::string messages;
  std::vector<std::string> left;  ///< files that were not there before
};

std::vector<std::string> files_below(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    names.push_back(entry.path().lexically_relative(folder));
  std::sort(names.begin(), names.end());
  return names;
}

/// The address space cannot be limited with a sanitizer, which maps terabytes.
constexpr const char* kMemoryLimit = kSanitized ? "" : "ulimit -v 8388608; ";

/// Soon is a matter of processor time, which other programs do not change. The program ends some 20
/// seconds before this limit. Only what waits for ever reaches the other one.
constexpr const char* kTimeLimit = kSanitized ? "" : "ulimit -t 40; ";
constexpr const char* kWallLimit = "timeout -k 1 600 ";

/// Runs `dapple render` in a shell, into out.exr. `limits` are shell commands that run before it.
Run render(const SceneFiles& files, const fs::path& folder, const std::string& options,
           const std::string& limits) {
  const fs::path inside = folder / "case";
  fs::create_directory(inside);
  write_files(files, inside);
  const auto before = files_below(inside);
  const fs::path log = folder / "log";
  const std::string command = "cd '" + inside.string() + "' && { " + limits + kTimeLimit +
                              kWallLimit + DAPPLE_PROGRAM " render " + files.scene +
                              " -o out.exr " + options + "; } >'" + log.string() +
                              "' 2>&1 </dev/null";
  const int status = std::system(command.c_str());
  Run run{WIFEXITED(status) ? WEXITSTATUS(status) : -1, film_test::bytes_of(log.string()), {}};
  const auto after = files_below(inside);
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::back_inserter(run.left));
  return run;
}

/// Describes what is wrong with the program's refusal of a case; empty if nothing is wrong.
std::string fault_of(const Malformed& malformed) {
  const TempFolder folder;
  const Run run = render(malformed.files, folder.path(""), "", kMemoryLimit);
  const auto lines = std::count(run.messages.begin(), run.messages.end(), '\n');
  if (run.code != static_cast<int>(ErrorKind::input))
    return "exit code " + std::to_string(run.code) + ": " + run.messages.substr(0, 500);
  if (static_cast<std::size_t>(lines) > kMaxLines) return "too many lines";
  if (run.messages.find(malformed.says) == std::string::npos)
    return "\"" + run.messages.substr(0, 500) + "\" lacks \"" + malformed.says + "\"";
  return run.left.empty() ? "" : "left behind: " + run.left.front();
}

/// Calls `work` for every case, in two threads, and reports the faults that it returns.
template <typename Case, typename Work>
void for_all(const std::vector<Case>& cases, const Work& work) {
  std::vector<std::string> faults(cases.size());
  const auto every_second = [&](std::size_t first) {
    for (std::size_t i = first; i < cases.size(); i += 2) faults[i] = work(cases[i]);
  };
  std::thread other(every_second, 1);
  every_second(0);
  other.join();
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (!faults[i].empty()) ADD_FAILURE() << cases[i].name << ": " << faults[i];
}

TEST(CorpusProgram, RefusesEveryMalformedSceneSoonAndCleanly) {
  for_all(malformed_corpus(), fault_of);
}

/// Without albedo: twins have the same opacity, not the same colours.
constexpr const char* kSmall =
    "--width 24 --height 24 --spp 16 --passes ao,light --estimator exact --look-from 2,2.5,5 "
    "--look-at 0,1,0 -q";

struct Picture {
  std::string fault;
  Film film;
};

Picture picture_of(const SceneFiles& files) {
  const TempFolder folder;
  const Run run = render(files, folder.path(""), kSmall, "");
  if (run.code != 0) return {"exit code " + std::to_string(run.code) + ": " + run.messages, {}};
  if (run.left != std::vector<std::string>{"out.exr"}) return {"other files than out.exr", {}};
  return {"", read_exr(folder.path("case/out.exr"))};
}

/// Describes how two pictures differ; empty if they agree. Triangles in another order, or with
/// another first corner, round differently, which moves a few samples across an edge.
std::string difference(const Film& a, const Film& b) {
  for (const char* channel : {"ao.G", "G", "A", "Z"}) {
    const Plane *pa = a.find(channel), *pb = b.find(channel);
    if (pa == nullptr || pb == nullptr) return std::string("no channel ") + channel;
    double squares = 0;
    for (std::size_t i = 0; i < pa->pixels.size(); ++i) {
      const double x = pa->pixels[i], y = pb->pixels[i];
      if (x != y) squares += (x - y) * (x - y);
    }
    const double rmse = std::sqrt(squares / double(pa->pixels.size()));
    if (!(rmse < 0.02)) return std::string(channel) + " differs by " + std::to_string(rmse);
  }
  return "";
}

std::string key_of(const SceneFiles& twin) {
  const Bytes& bytes = twin.files.at(twin.scene);
  return {bytes.begin(), bytes.end()};
}

TEST(CorpusProgram, RendersEveryTrickySceneLikeItsPlainTwin) {
  const TrickyCases cases = tricky_corpus();
  std::map<std::string, Film> twins;
  for (const Tricky& tricky : cases) {
    const std::string key = key_of(tricky.plain);
    if (twins.contains(key)) continue;
    Picture plain = picture_of(tricky.plain);
    ASSERT_EQ(plain.fault, "") << tricky.name;
    twins[key] = std::move(plain.film);
  }
  for_all(cases, [&](const Tricky& tricky) {
    const Picture picture = picture_of(tricky.files);
    if (!picture.fault.empty()) return picture.fault;
    return difference(picture.film, twins.at(key_of(tricky.plain)));
  });
}

}  // namespace
}  // namespace dapple::test
