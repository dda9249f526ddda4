// Bytes that are no UTF-8: where files hold text, U+FFFD stands for them.
#include "files/utf8.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace dapple {
namespace {

const std::string kReplaced = "\xef\xbf\xbd";  // U+FFFD

TEST(Utf8, KeepsWhatIsValid) {
  const std::string texts[] = {"",
                               "tree.glb",
                               "Bäume/größe \"1\"\\\n\t\x01.glb",
                               std::string("a\0b", 3),
                               "\xf0\x9f\x8c\xb3",
                               kReplaced};
  for (const std::string& text : texts) EXPECT_EQ(utf8_of(text), text);
}

TEST(Utf8, ReplacesTheBytesThatAreNone) {
  EXPECT_EQ(utf8_of("tr\xe9"), "tr" + kReplaced);
  EXPECT_EQ(utf8_of("\xff\xfe.glb"), kReplaced + kReplaced + ".glb");
  EXPECT_EQ(utf8_of("\xc3(\xc3\xa4"), kReplaced + "(ä");
}

TEST(Utf8, IsWhatJsonFilesHave) {
  for (const std::string text : {"tr\xe9\x65.glb", "\xf0\x9f\x8c", "\x80\x80 \xed\xa0\x80"}) {
    using nlohmann::json;
    const std::string file = json(text).dump(2, ' ', false, json::error_handler_t::replace);
    EXPECT_EQ(json::parse(file).get<std::string>(), utf8_of(text));
  }
}

}  // namespace
}  // namespace dapple
