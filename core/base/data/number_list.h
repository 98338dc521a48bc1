// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Several numbers in one parameter: "120,80 1900,95".
#include <optional>
#include <string_view>
#include <vector>

namespace formwright {

/// Finite numbers with blanks, commas or semicolons between them; none where anything else is in the text.
std::optional<std::vector<double>> read_number_list(std::string_view text);

}  // namespace formwright
