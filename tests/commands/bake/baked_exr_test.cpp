// NAME_baked.exr says what it was made with, by the names that pictures use, and how large the bias
// is.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "dapple/film.hpp"
#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

class BakedExr : public BakeCommand {
 protected:
  /// The metadata of a texture of a tree.
  [[nodiscard]] std::map<std::string, std::string> baked(const std::string& options) const {
    const Outcome run = dapple(
        "bake 'scene:tree?leaves=100' -o out.glb --to texture --size 128 --seed 7 --opacity "
        "leaf=0.5 --ao-distance 9 --stats-json s.json " +
        options);
    EXPECT_EQ(run.code, 0) << run.err;
    return metadata_of("out_baked.exr");
  }

  [[nodiscard]] std::map<std::string, std::string> metadata_of(const std::string& name) const {
    const FilmMetadata m = read_exr(path(name)).metadata;
    std::map<std::string, std::string> all(m.settings.begin(), m.settings.end());
    all.insert({{"scene", m.scene},
                {"device", m.device},
                {"version", m.version},
                {"seed", std::to_string(m.seed)},
                {"samples", std::to_string(m.samples)}});
    return all;
  }

  [[nodiscard]] json statistics() const { return json::parse(bytes_of(path("s.json"))); }
};

TEST_F(BakedExr, HasTheMetadataOfAPictureOfTheSameScene) {
  const Outcome run = dapple(
      "render 'scene:tree?leaves=100' -o picture.exr --width 8 --height 8 --seed 7 --opacity "
      "leaf=0.5 --ao-distance 9");
  ASSERT_EQ(run.code, 0) << run.err;
  auto picture = metadata_of("picture.exr"), texture = baked("--passes ao,bent");
  for (const char* name : {"scene", "device", "version", "seed", "estimator", "normals",
                           "ao_distance", "ao_falloff", "opacity_leaf"}) {
    EXPECT_FALSE(picture[name].empty()) << name;
    EXPECT_EQ(texture[name], picture[name]) << name;
  }
}

TEST_F(BakedExr, HasTheRaysAndTheTarget) {
  auto both = baked("--passes ao,bent --rays 32 --target-error 0.1");
  EXPECT_EQ(both["rays"], "32");
  EXPECT_EQ(both["samples"], "32");
  EXPECT_EQ(both["target_error"], "0.1");
  EXPECT_FALSE(both.contains("light_rays"));
  EXPECT_FALSE(both.contains("max_bias"));
  EXPECT_FALSE(baked("--passes ao,bent --rays 32").contains("target_error"));
}

TEST_F(BakedExr, HasTheBiasThatTheStatisticsHave) {
  std::ofstream(path("sun.json")) << R"({"lights": [{"type": "sun", "name": "noon",
      "direction": [0, -1, 0], "irradiance": [1, 1, 1]}]})";
  std::map<std::string, std::string> metadata;
  json biases;
  // The clock bounds what is compared: on a busy machine there may be too little light.
  for (int rays = 64; rays <= 16384 && biases.size() < 2; rays *= 4) {
    metadata =
        baked("--passes ao,light --lights sun.json --light-rays 4 --report-bias 100% --rays " +
              std::to_string(rays));
    biases = statistics()["bias"];
  }
  ASSERT_EQ(biases.size(), 2u);
  EXPECT_EQ(metadata["light_rays"], "4");
  for (const char* layer : {"ao", "light"}) {
    const json bias = biases[layer];
    EXPECT_EQ(metadata[std::string("bias.") + layer],
              fmt::format("{:+.4f} +- {:.4f}, RMSE over tiles {:.4f}", bias["mean"].get<double>(),
                          bias["error"].get<double>(), bias["tile_rmse"].get<double>()));
  }
}

TEST_F(BakedExr, HasTheFootprintThatWasChosenAndNoBiasOfExactRays) {
  auto metadata = baked("--passes ao,bent --rays 64 --max-bias 1e-7");
  EXPECT_EQ(metadata["max_bias"], "1e-07");
  EXPECT_EQ(metadata["footprint"], "0");
  metadata = baked("--passes ao,bent --rays 64");
  EXPECT_EQ(metadata["footprint"], "1.5");
  EXPECT_TRUE(metadata.contains("bias.ao"));
  metadata = baked("--passes ao,bent --rays 64 --estimator exact");
  EXPECT_EQ(metadata["estimator"], "exact");
  EXPECT_FALSE(metadata.contains("bias.ao"));
}

}  // namespace
}  // namespace dapple
