// An environment variable that is set while an object lives: OpenCL drivers read it when they
// start, and processes that are started later must not inherit it.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace dapple {

class EnvironmentWhile {
 public:
  /// Sets variable `name`, which must outlive the object. An empty `value` changes nothing.
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
