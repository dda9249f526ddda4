// The key "bias" of --stats-json, which render, bake and points write alike. Of exact rays there is
// none.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using nlohmann::json;

class BiasJson : public program_test::ProgramRun {
 protected:
  BiasJson() {
    std::ofstream(path("sun.json")) << R"({"lights": [{"type": "sun", "name": "noon",
        "direction": [0, -1, 0], "angle_degrees": 20, "irradiance": [1, 1, 1]}]})";
  }

  /// The statistics of a command on dense leaves, whose bias is large.
  [[nodiscard]] json statistics(const std::string& command, const std::string& arguments) const {
    const program_test::Outcome run =
        dapple(command + " 'scene:tree?leaves=3000' --stats-json s.json " + arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return json::parse(film_test::bytes_of(path("s.json")));
  }

  /// Of each of `layers` and no others; at least one of them has a bias of more than `errors`
  /// standard errors.
  static void expect_bias(const json& statistics, const std::set<std::string>& layers,
                          double errors = 2) {
    const json& all = statistics.at("bias");
    std::set<std::string> found;
    double largest = 0;
    for (const auto& [layer, bias] : all.items()) {
      SCOPED_TRACE(layer + ": " + bias.dump());
      found.insert(layer);
      ASSERT_EQ(bias.size(), 5u);
      const auto of = [&](const char* key) { return bias.at(key).get<double>(); };
      EXPECT_LT(std::fabs(of("mean")), 0.1);
      EXPECT_GT(of("error"), 0);
      EXPECT_LT(of("error"), 0.1);
      EXPECT_GE(of("tile_rmse"), 0);
      EXPECT_GE(of("tile_rmse_limit"), of("tile_rmse"));
      EXPECT_GT(of("tile_rmse_limit"), 0);
      EXPECT_GT(of("share_of_rays"), 0);
      EXPECT_LE(of("share_of_rays"), 1);
      largest = std::max(largest, std::fabs(of("mean")) - errors * of("error"));
    }
    EXPECT_EQ(found, layers);
    EXPECT_GT(largest, 0) << all;
  }
};

TEST_F(BiasJson, OfAPictureItHasTheLayers) {
  const std::string picture =
      "-o out.exr --width 96 --height 96 --spp 8 --lights sun.json --report-bias ";
  const json all = statistics("render", picture + "100%"),
             some = statistics("render", picture + "25%");
  expect_bias(all, {"ao", "light.noon"});
  expect_bias(some, {"ao", "light.noon"}, 1);
  EXPECT_NEAR(all["bias"]["ao"]["share_of_rays"].get<double>(), 1, 1e-6);
  EXPECT_LT(some["bias"]["ao"]["share_of_rays"].get<double>(), 0.5);
  EXPECT_FALSE(statistics("render", picture + "100% --footprint 0").contains("bias"));
}

TEST_F(BiasJson, OfABakeItHasAoAndAllLightsTogether) {
  const std::string values = "-o out.glb --passes ao,light --lights sun.json --report-bias ";
  expect_bias(statistics("bake", values + "100%"), {"ao", "light"});
  EXPECT_TRUE(statistics("bake", values + "0").at("bias").empty());
  EXPECT_TRUE(statistics("bake", values + "100% --estimator exact").at("bias").empty());
}

TEST_F(BiasJson, OfPointsItHasTheQuantities) {
  const std::string points =
      "-o out.csv --grid=-2,-2,2,2,0.1 --lights sun.json --rings 2 --rays 256 ";
  expect_bias(statistics("points", points),
              {"ao", "sky_view_factor", "gap_1", "gap_2", "light.noon"});
  EXPECT_TRUE(statistics("points", points + "--report-bias 0").at("bias").empty());
  EXPECT_TRUE(statistics("points", points + "--estimator exact").at("bias").empty());
}

}  // namespace
}  // namespace dapple
