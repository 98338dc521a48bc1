// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The one exception of the core. Only job/run catches it.
#include <stdexcept>
#include <string>

namespace formwright {

enum class ErrorCode {
  invalid_input,    // the caller can fix it: bad file, bad value, unknown name
  could_not_solve,  // the input is fine, the numbers are not: singular, infeasible, not converged
  cancelled,
  out_of_memory,
  internal,  // a bug of ours
};

/// What went wrong, where (the name of a parameter, an input or an output; may be empty) and one
/// sentence for a person, which names the fix. The page highlights the control called `where`.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, std::string where, const std::string& message)
      : std::runtime_error(message), code_(code), where_(std::move(where)) {}
  ErrorCode code() const noexcept { return code_; }
  const std::string& where() const noexcept { return where_; }

 private:
  ErrorCode code_;
  std::string where_;
};

/// Stable name of a code, as it stands in job messages: "invalid_input", ...
const char* to_string(ErrorCode code);

}  // namespace formwright
