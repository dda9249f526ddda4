// Text that is not JSON, and JSON that the reader must refuse: too deep, too large, or with the
// same key twice.
#include "corpus/corpus.hpp"

namespace dapple::test {
namespace {

std::string repeated(const std::string& text, std::size_t times) {
  std::string result;
  for (std::size_t i = 0; i < times; ++i) result += text;
  return result;
}

/// A valid document with `text` as the value of its asset's extras.
std::string with_extras(const std::string& text) {
  GltfBuilder builder = one_triangle();
  builder.doc["buffers"] = json::array({{{"uri", "scene.bin"}, {"byteLength", 36}}});
  std::string document = builder.doc.dump();
  const std::string version = R"("version":"2.0")";
  document.insert(document.find(version), std::string(R"("extras":)").append(text).append(","));
  return document;
}

struct Text {
  const char* name;
  std::string text;
  const char* says;
};

std::vector<Text> broken_texts() {
  const std::string sound = with_extras("0");
  std::string utf16(1, '\xff');
  utf16 += '\xfe';
  for (const char c : sound) utf16 += {c, '\0'};
  return {
      {"only_spaces", "   \n", "is not glTF"},
      {"a_number", "42", "no object"},
      {"an_array", "[]", "no object"},
      {"a_string", "\"glTF\"", "no object"},
      {"null", "null", "no object"},
      {"an_empty_object", "{}", "asset is missing"},
      {"half", sound.substr(0, sound.size() / 2), "is not glTF"},
      {"without_the_last_brace", sound.substr(0, sound.size() - 1), "is not glTF"},
      {"a_brace_more", sound + "}", "is not glTF"},
      {"two_documents", sound + sound, "is not glTF"},
      {"junk_behind", sound + " glTF", "is not glTF"},
      {"nul_inside", std::string(sound).insert(10, 1, '\0'), "is not glTF"},
      {"utf_16", utf16, "is not glTF"},
      {"trailing_comma", with_extras("[1,]"), "is not glTF"},
      {"comment", std::string("// glTF\n").append(sound), "is not glTF"},
      {"block_comment", with_extras("/* none */ 0"), "is not glTF"},
      {"single_quotes", with_extras("'a'"), "is not glTF"},
      {"bare_key", with_extras("{a:1}"), "is not glTF"},
      {"nan", with_extras("NaN"), "is not glTF"},
      {"infinity", with_extras("Infinity"), "is not glTF"},
      {"minus_infinity", with_extras("-Infinity"), "is not glTF"},
      {"hexadecimal", with_extras("0x10"), "is not glTF"},
      {"leading_zero", with_extras("012"), "is not glTF"},
      {"leading_plus", with_extras("+1"), "is not glTF"},
      {"number_past_double", with_extras("1e400"), "is not glTF"},
      {"lone_minus", with_extras("-"), "is not glTF"},
      {"invalid_utf_8", with_extras("\"\xc3\x28\""), "is not glTF"},
      {"overlong_utf_8", with_extras("\"\xc0\xaf\""), "is not glTF"},
      {"cut_utf_8", with_extras("\"\xe2\x82\""), "is not glTF"},
      {"lone_surrogate", with_extras("\"\\ud800\""), "is not glTF"},
      {"bad_escape", with_extras("\"\\x41\""), "is not glTF"},
      {"line_break_in_a_string", with_extras("\"a\nb\""), "is not glTF"},
      {"open_string", with_extras("\"abc"), "is not glTF"},
      {"deep_arrays", with_extras(repeated("[", 100000) + repeated("]", 100000)), "nested deeper"},
      {"deep_objects", with_extras(repeated("{\"a\":", 100000) + "0" + repeated("}", 100000)),
       "nested deeper"},
      {"deep_and_open", repeated("[", 1000000), "nested deeper"},
      {"rather_deep", with_extras(repeated("[", 600) + repeated("]", 600)), "nested deeper"},
      {"objects_by_the_million",
       with_extras(std::string("[").append(repeated("{},", 4300000)).append("0]")),
       "more than 4,194,304 objects"},
      {"key_twice", with_extras(R"({"a":1,"a":2})"), "the key \"a\" twice"},
      {"key_twice_by_escape", with_extras("{\"a\":1,\"\\u0061\":2}"), "the key \"a\" twice"},
  };
}

}  // namespace

void add_malformed_json(MalformedCases& cases) {
  for (const Text& text : broken_texts()) {
    SceneFiles files = as_text(text.text);
    files.files["scene.bin"] = one_triangle().bin;
    cases.push_back({std::string("json_") + text.name, files, text.says});
  }
  std::string twice = with_extras("0");
  twice.insert(twice.rfind('}'), R"(,"meshes":[])");
  SceneFiles files = as_text(twice);
  files.files["scene.bin"] = one_triangle().bin;
  cases.push_back({"json_meshes_twice", files, "the key \"meshes\" twice"});
}

}  // namespace dapple::test
