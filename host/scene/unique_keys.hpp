// Keys that are twice in one JSON object: readers differ in which of the two they take, so
// that a file with such keys means nothing.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace dapple {

/// Follows nlohmann's parser by its callback.
class UniqueKeys {
 public:
  /// False for a key that its object already has.
  [[nodiscard]] bool see(nlohmann::json::parse_event_t event, const nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    return event != Event::key || open_.back().insert(parsed.get<std::string>()).second;
  }

 private:
  std::vector<std::set<std::string>> open_;
};

}  // namespace dapple
