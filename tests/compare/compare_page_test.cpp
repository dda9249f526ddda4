// Output of `dapple compare`: the text, the HTML page with its pictures decoded again, JSON, the
// heat map, and the program's exit codes.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <gtest/gtest.h>
#include <stb_image.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "compare/data_uri.hpp"
#include "compare/figures_text.hpp"
#include "compare/heat_map.hpp"
#include "compare/page.hpp"
#include "support/compare_films.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace compare_test;

TEST(CompareText, ShowsOneLineALayerAndLeavesOutWhatNeverApplies) {
  const Film b =
      film_of(64, 1, {{"Y", std::vector<float>(64, 0)}, {"Z", std::vector<float>(64, 2)}});
  Film a = b;
  a.planes[0].pixels[63] = 1;
  Comparison c = compared(a, b);
  c.only_b = {"ao", "N.X"};
  // The mean is 1/64, the RMSE 1/8, the relative MSE (1 / 0.01) / 64, the worst window's RMSE
  // 1 / sqrt(32).
  const std::string text = comparison_text(c);
  EXPECT_EQ(text,
            "A = a.exr, B = b.exr: 64 x 1 pixels\n"
            "layer    mean A  mean B     A - B   RMSE  rel. MSE  max |A-B|       at  worst RMSE  "
            "worst window\n"
            "Y      0.015625       0  0.015625  0.125    1.5625          1  73,20 Y    0.176777  "
            " 42,20,73,20\n"
            "Z             2       2         0      0         0          0        -           0  "
            " 10,20,41,20\n"
            "only in B: ao N.X\n");
}

TEST(DataUri, IsBase64AsInTheRfcsExamples) {
  const char* const texts[] = {"", "f", "fo", "foo", "foob", "fooba", "foobar"};
  const char* const codes[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (int i = 0; i < 7; ++i) EXPECT_EQ(base64(texts[i]), codes[i]);
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
  EXPECT_EQ(escape_html("<a href=\"b\">&'"), "&lt;a href=&quot;b&quot;&gt;&amp;&#39;");
  EXPECT_EQ(escape_html("<tr\xe9>"), "&lt;tr\xef\xbf\xbd&gt;") << "U+FFFD for a byte of Latin 1";
}

std::string decode_base64(const std::string& text) {
  static const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    bits = bits << 6U | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8));
  }
  return bytes;
}

struct Pixels {
  int width = 0, height = 0, channels = 0;
  std::vector<int> values;
};

Pixels decode_png(const std::string& png) {
  Pixels p;
  stbi_uc* values =
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(png.data()),
                            static_cast<int>(png.size()), &p.width, &p.height, &p.channels, 0);
  EXPECT_NE(values, nullptr);
  if (values != nullptr) p.values.assign(values, values + p.width * p.height * p.channels);
  stbi_image_free(values);
  return p;
}

std::vector<Pixels> pictures_in(const std::string& html) {
  static const std::string start = "src=\"data:image/png;base64,";
  std::vector<Pixels> pictures;
  for (auto at = html.find(start); at != std::string::npos; at = html.find(start, at)) {
    at += start.size();
    pictures.push_back(decode_png(decode_base64(html.substr(at, html.find('"', at) - at))));
  }
  return pictures;
}

// Checks that elements are closed in order; returns the first tag that breaks this, or "".
std::string first_unbalanced_tag(std::string html) {
  html = std::regex_replace(html, std::regex("<script>[^]*</script>"), "");
  static const std::set<std::string> empty{"meta", "link", "img", "input"};
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z][a-z0-9]*)(\\s[^<>]*)?>");
  html = std::regex_replace(html, std::regex("base64,[A-Za-z0-9+/=]*"), "");
  for (std::sregex_iterator it(html.begin(), html.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if ((*it)[1].length() == 0) {
      if (!empty.contains(name)) open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return name;
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : open.back();
}

TEST(ComparePage, HoldsPicturesAndFiguresAndRequestsNoOtherFile) {
  const Film b = film_of(3, 2,
                         {{"B", noise(6, 1)},
                          {"G", noise(6, 2)},
                          {"R", noise(6, 3)},
                          {"light.<b>.R", constant(6, 2)},
                          {"odd.U", noise(6, 4)}});
  Film a = b;
  a.planes[3].pixels = constant(6, 1);
  a.planes[4].pixels[2] = kInfinity;
  Comparison c = compared(a, b);
  c.name_a = "\"a\" & <script>.exr";
  const LayerMatch match = match_layers(a, b);
  const std::string html = comparison_page(a, b, match.pairs, c, {10.0, "a <reason>"});

  for (const char* const request :
       {"http:", "https:", "url(", "@import", "href=\"/", "<script>.exr", "<b>", "<reason>"}) {
    EXPECT_FALSE(contains(html, request)) << request;
  }
  EXPECT_TRUE(contains(html, "default-src 'none'"));
  EXPECT_TRUE(contains(html, "a &lt;reason&gt;"));
  EXPECT_EQ(first_unbalanced_tag(html), "");
  for (const LayerDifference& layer : c.layers) {
    for (const FigureColumn& column : figure_columns()) {
      EXPECT_TRUE(
          contains(html, std::string(">").append(escape_html(column.cell(layer))).append("</t")))
          << layer.layer << " " << column.heading;
    }
  }
  // Three pictures (A, B and the heat map) of three layers.
  const std::vector<Pixels> pictures = pictures_in(html);
  ASSERT_EQ(pictures.size(), 9U);
  for (const Pixels& picture : pictures) {
    EXPECT_EQ(picture.width, 3);
    EXPECT_EQ(picture.height, 2);
  }
  // The light in A is half as strong as in B. Both are shown relative to B's largest value, so A is
  // 0.5, which is 188 in sRGB.
  EXPECT_EQ(pictures[3].values, std::vector<int>(6, 188));
  EXPECT_EQ(pictures[4].values, std::vector<int>(6, 255));
}

class CompareProgram : public FilmFile {
 protected:
  // Runs `dapple compare`; returns its exit code. What it printed is in the files "out" and "err".
  [[nodiscard]] int run(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && '" DAPPLE_PROGRAM "' compare " +
                                arguments + " > out 2> err";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::string out() const { return bytes_of(path("out")); }
  [[nodiscard]] std::string err() const { return bytes_of(path("err")); }
};

TEST_F(CompareProgram, ExitsWithFiveWhenALayerIsOverTheLimitAndStillWritesEverything) {
  Film b = film_of(64, 48, {{"Z", constant(3072, kInfinity)}, {"ao.R", noise(3072, 1)}});
  Film a = b;
  for (float& value : a.planes[1].pixels) value += 0.125f;
  write_exr(a, path("a.exr"));
  write_exr(b, path("b.exr"));

  EXPECT_EQ(run("b.exr b.exr --max-rmse 0"), 0) << err();
  EXPECT_TRUE(contains(out(), "ao")) << out();
  EXPECT_EQ(run("a.exr b.exr"), 0) << err();
  EXPECT_EQ(run("a.exr b.exr --max-rmse 0.126"), 0) << err();
  EXPECT_EQ(run("a.exr b.exr --max-rmse 0.124 --json --html p.html --png h.png --scale 8"), 5);
  EXPECT_EQ(err(),
            "dapple: a.exr and b.exr differ: layer ao has RMSE 0.125; --max-rmse is 0.124\n");
  EXPECT_FALSE(nlohmann::json::parse(out()).at("passed"));
  EXPECT_TRUE(contains(bytes_of(path("p.html")), "layer ao has RMSE 0.125"));
  EXPECT_GT(bytes_of(path("h.png")).size(), 0U);
  EXPECT_EQ(run("a.exr b.exr --max-rmse 0.124 --layer Z"), 0) << err();
  b.planes.pop_back();
  write_exr(b, path("z.exr"));
  EXPECT_EQ(run("z.exr a.exr --max-rmse 1"), 5);
  EXPECT_EQ(run("z.exr a.exr --max-rmse 1 --layer Z"), 0) << err();
  EXPECT_EQ(out().find("only in"), std::string::npos) << out();
}

TEST_F(CompareProgram, PrintsJsonAndWritesTheHeatMapAndThePage) {
  // 0.125 is added to multiples of 2^-24 below 1. The sum is exact if it is below 1; larger sums
  // are rounded by at most 2^-25.
  const Film b = film_of(64, 48, {{"ao.R", noise(3072, 1)}, {"light.key.R", constant(3072, 2)}});
  Film a = b;
  for (float& value : a.planes[0].pixels) value += 0.125f;
  write_exr(a, path("a.exr"));
  write_exr(b, path("b.exr"));
  ASSERT_EQ(run("a.exr b.exr --json --html p.html --png h.png --scale 8"), 0) << err();
  const auto json = nlohmann::json::parse(out());
  ASSERT_EQ(json.at("layers").size(), 2U);
  const auto& ao = json.at("layers").at(0);
  EXPECT_EQ(ao.at("layer"), "ao");
  EXPECT_NEAR(ao.at("rmse").get<double>(), 0.125, 1e-7);
  EXPECT_NEAR(ao.at("mean_difference").get<double>(), 0.125, 1e-7);
  EXPECT_EQ(json.at("layers").at(1).at("rmse_of_largest"), 0.0);
  EXPECT_EQ(json.at("passed"), true);

  const Pixels heat = decode_png(bytes_of(path("h.png")));  // of ao, the first layer
  EXPECT_EQ(heat.width, 64);
  EXPECT_EQ(heat.height, 48);
  const Rgb hot = kHeatRamp.back();  // the colour of 0.125 at scale 8
  for (std::size_t i = 0; i < heat.values.size(); ++i) {
    ASSERT_NEAR(heat.values[i], hot[i % 3], 1) << i;  // a rounded difference may be smaller
  }
  EXPECT_EQ(pictures_in(bytes_of(path("p.html"))).size(), 6U);
}

TEST_F(CompareProgram, RefusesWhatCannotBeCompared) {
  write_exr(film_of(4, 2, {{"ao.R", constant(8, 1)}}), path("a.exr"));
  write_exr(film_of(5, 2, {{"ao.R", constant(10, 1)}}), path("wide.exr"));
  write_exr(film_of(4, 2, {{"Z", constant(8, 1)}}), path("z.exr"));
  write_exr(film_of(4, 2, {{"ao.R", constant(8, kNan)}}), path("nan.exr"));
  EXPECT_EQ(run("a.exr wide.exr"), 3);
  EXPECT_TRUE(contains(err(), "4 x 2") && contains(err(), "5 x 2")) << err();
  EXPECT_EQ(run("a.exr z.exr"), 3);
  EXPECT_TRUE(contains(err(), "no layer in common")) << err();
  EXPECT_EQ(run("a.exr missing.exr"), 3);
  EXPECT_EQ(run("a.exr a.exr --layer light.key"), 2);
  EXPECT_TRUE(contains(err(), "there are: ao")) << err();
  EXPECT_EQ(run("a.exr a.exr --scale 0"), 2);
  EXPECT_EQ(run("a.exr a.exr --max-rmse nan"), 2);
  EXPECT_EQ(run("a.exr a.exr --html missing/p.html"), 2);
  EXPECT_EQ(run("nan.exr nan.exr"), 5);
  EXPECT_EQ(run("nan.exr a.exr --json"), 5);
  EXPECT_EQ(nlohmann::json::parse(out()).at("passed"), false);
}

}  // namespace
}  // namespace dapple
