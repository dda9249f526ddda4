// The settings that a checkpoint compares: every option that changes a picture's bits is among
// them. In: options that differ in one thing; out: the name of that option.
#include "render/render_settings.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace dapple {
namespace {

View view_of(const RenderOptions& options) {
  return {Camera(), options.width, options.height,
          options.crop.value_or(PixelRect{0, 0, options.width - 1, options.height - 1})};
}

TEST(OptionSettings, NameTheOptionThatChangesThePicture) {
  using Change = std::function<void(RenderOptions&)>;
  const std::pair<const char*, Change> changes[] = {
      {"--width", [](auto& o) { o.width = 99; }},
      {"--height", [](auto& o) { o.height = 99; }},
      {"--crop",
       [](auto& o) {
         o.crop = PixelRect{1, 2, 3, 4};
       }},
      {"--shard",
       [](auto& o) {
         o.shard = {2, 3};
       }},
      {"--seed", [](auto& o) { o.seed = 7; }},
      {"--estimator", [](auto& o) { o.estimator = Estimator::exact; }},
      {"--packets", [](auto& o) { o.packets = Packets::none; }},
      {"--footprint", [](auto& o) { o.footprint = 3.5f; }},
      {"--roulette", [](auto& o) { o.roulette = 0.5f; }},
      {"--max-bias", [](auto& o) { o.max_bias = 0.1f; }},
      {"--normals", [](auto& o) { o.normals = Normals::geometric; }},
      {"--passes", [](auto& o) { o.albedo = !o.albedo; }},
      {"--passes", [](auto& o) { o.back = !o.back; }},
      {"--camera-splitting", [](auto& o) { o.camera_splitting = 2; }},
      {"--ao-rays", [](auto& o) { o.ao_rays = 9; }},
      {"--light-rays", [](auto& o) { o.light_rays = 9; }},
      {"--ao-distance", [](auto& o) { o.ao_distance = 9; }},
      {"--ao-falloff", [](auto& o) { o.ao_falloff = 2; }},
      {"--cryptomatte", [](auto& o) { o.cryptomattes.materials = true; }},
      {"--target-error or --target-rmse", [](auto& o) { o.target_rmse = 0.1f; }},
  };
  const RenderOptions plain;
  const Settings of_plain = option_settings(plain, view_of(plain));
  for (const auto& [name, change] : changes) {
    RenderOptions options;
    change(options);
    RenderOptions of_view = options;
    of_view.width = plain.width;  // the crop of a larger picture would be another one, too
    of_view.height = plain.height;
    const auto difference = first_difference(of_plain, option_settings(options, view_of(of_view)));
    ASSERT_TRUE(difference) << name;
    EXPECT_EQ(difference->name, name);
  }
}

TEST(OptionSettings, HaveBackEveryOnlyWithThePassBack) {
  const auto difference = [](bool back) {
    RenderOptions then, now;
    then.back = now.back = back;
    then.back_every = 16;
    now.back_every = 4;
    return first_difference(option_settings(then, view_of(then)),
                            option_settings(now, view_of(now)));
  };
  EXPECT_FALSE(difference(false));
  const auto with_backs = difference(true);
  ASSERT_TRUE(with_backs);
  EXPECT_EQ(with_backs->name, "--back-every");
  EXPECT_EQ(with_backs->before, "16");
  EXPECT_EQ(with_backs->now, "4");
}

TEST(OptionSettings, LetTheNumberOfSamplesGrow) {
  const RenderOptions plain;
  RenderOptions more;
  more.spp = 2 * plain.spp;
  EXPECT_FALSE(first_difference(option_settings(plain, view_of(plain)),
                                option_settings(more, view_of(more))));
}

}  // namespace
}  // namespace dapple
