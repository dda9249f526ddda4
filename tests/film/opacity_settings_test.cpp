#include "film/opacity_settings.hpp"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

TEST(OpacitySettings, MaterialsWhoseLayerNamesAreEqualHaveSettingsOfTheirOwn) {
  EXPECT_EQ(opacity_settings({{"a b", 0.5f}, {"a_b", 0.25f}}),
            (Settings{{"opacity_a_b", "0.5"}, {"opacity_a_b_2", "0.25"}}));
}

TEST(OpacitySettings, ValuesOfOneMaterialHaveOneName) {
  EXPECT_EQ(opacity_settings({{"leaf", 0.5f}, {"wood", 1}, {"leaf", 0.25f}}),
            (Settings{{"opacity_leaf", "0.5"}, {"opacity_wood", "1"}, {"opacity_leaf", "0.25"}}));
}

}  // namespace
}  // namespace dapple
