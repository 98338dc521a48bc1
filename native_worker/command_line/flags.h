// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Flags of a command line, read by CLI11; every command declares its own.
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace formwright {

struct FlagRule {
  enum class Value { none, one, optional };  // optional: "on" where the next word is another flag
  std::string name;                          // "--out"; without dashes: a word that stands alone
  Value value = Value::one;
};

/// The flags that were given, each with its values in their order; "on" stands for a flag without a value.
using FlagValues = std::map<std::string, std::vector<std::string>>;

/// Reads `--flag value` and `--flag=value`; the word behind a flag that needs a value is its value, whatever it looks
/// like. Throws Error{invalid_input} naming the flag: without its value, or a word that no rule knows, with the
/// sentence that `unknown` makes of it (of `--flag=value` the flag).
FlagValues read_flags(const std::vector<std::string>& words, const std::vector<FlagRule>& rules,
                      const std::function<std::string(const std::string& word)>& unknown);

}  // namespace formwright
