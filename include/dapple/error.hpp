// The one exception type of dapple: thrown anywhere, caught in main(), where its
// kind becomes the exit code. Our own bugs are assert()s, never Errors.
#pragma once

#include <stdexcept>
#include <string>

namespace dapple {

/// What went wrong, in the words of the exit codes.
enum class ErrorKind {
  failed = 1,     ///< the work could not be finished (disk, memory, a device that died)
  usage = 2,      ///< an option is wrong or missing
  input = 3,      ///< a scene, texture or lights file is wrong
  device = 4,     ///< no usable OpenCL device
  different = 5,  ///< the pictures compared differ by more than was allowed
};

/// `what()` is one line: which file or option, which element, what next.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace dapple
