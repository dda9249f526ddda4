#include "files/utf8.hpp"

#include <nlohmann/json.hpp>

namespace dapple {

std::string utf8_of(const std::string& bytes) {
  using nlohmann::json;
  return json::parse(json(bytes).dump(-1, ' ', false, json::error_handler_t::replace))
      .get<std::string>();
}

}  // namespace dapple
