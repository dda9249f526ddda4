// The one exception type of dapple. Any function may throw it; main() catches it and makes its kind
// the exit code. Bugs of dapple itself are found by assert() and are never Errors.
#pragma once

#include <stdexcept>
#include <string>

namespace dapple {

/// The kind of failure; its value is the exit code.
enum class ErrorKind {
  failed = 1,     ///< the work could not be finished (disk, memory, a device that died)
  usage = 2,      ///< an option is wrong or missing
  input = 3,      ///< a scene, texture or lights file is wrong
  device = 4,     ///< no usable OpenCL device
  different = 5,  ///< the compared pictures differ by more than was allowed
};

/// `what()` is one line: the file or option, the element, and what the user can do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace dapple
