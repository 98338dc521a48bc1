// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Completions of commands, flags and their values, from the catalog.
#include <string>

namespace formwright {

/// A script for "bash", "zsh" or "fish", to be put where the shell looks for `formwright`'s.
/// Throws Error{invalid_input} for another shell.
std::string shell_completions(const std::string& shell);

}  // namespace formwright
