// An event (SAX) handler for nlohmann's parser: see json_structure.hpp. It does not use nlohmann's
// parse callback, which visits a whole array again at the end of each of its elements.
#include "scene/json_structure.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace dapple {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxKeyLength = 120;  // bytes of a key in a message

class StructureCheck : public nlohmann::json_sax<Json> {
 public:
  explicit StructureCheck(std::size_t max_depth) : max_depth_(max_depth) {}

  [[nodiscard]] const std::string& defect() const { return defect_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(std::int64_t) override { return true; }
  bool number_unsigned(std::uint64_t) override { return true; }
  bool number_float(double, const std::string&) override { return true; }
  bool string(std::string&) override { return true; }
  bool binary(Json::binary_t&) override { return true; }

  bool start_object(std::size_t) override {
    keys_.emplace_back();
    return descend();
  }
  bool end_object() override {
    keys_.pop_back();
    --depth_;
    return true;
  }
  bool start_array(std::size_t) override { return descend(); }
  bool end_array() override {
    --depth_;
    return true;
  }
  bool key(std::string& key) override {
    if (keys_.back().insert(key).second) return true;
    defect_ = fmt::format("has the key \"{}\" twice in one object", key.substr(0, kMaxKeyLength));
    return false;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  bool descend() {
    if (++depth_ <= max_depth_) return true;
    defect_ = fmt::format("nests deeper than {} levels", max_depth_);
    return false;
  }

  std::size_t max_depth_;
  std::size_t depth_ = 0;
  std::vector<std::set<std::string>> keys_;
  std::string defect_;
};

}  // namespace

std::string json_structure_defect(std::string_view text, std::size_t max_depth) {
  StructureCheck check(max_depth);
  Json::sax_parse(text, &check);
  return check.defect();
}

}  // namespace dapple
