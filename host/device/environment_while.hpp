// An environment variable set for a while: what an OpenCL driver reads when it starts, and what
// processes that we start later must not inherit.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace dapple {

class EnvironmentWhile {
 public:
  /// An empty `value` leaves the variable as it is.
  EnvironmentWhile(const char* name, const std::string& value) : name_(name) {
    if (value.empty()) return;
    if (const char* former = std::getenv(name)) former_ = former;
    setenv(name, value.c_str(), 1);
    set_ = true;
  }
  ~EnvironmentWhile() {
    if (!set_) return;
    if (former_) {
      setenv(name_, former_->c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }
  EnvironmentWhile(const EnvironmentWhile&) = delete;
  EnvironmentWhile& operator=(const EnvironmentWhile&) = delete;

 private:
  const char* name_;
  bool set_ = false;
  std::optional<std::string> former_;
};

}  // namespace dapple
