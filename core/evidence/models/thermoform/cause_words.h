// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What happened, in a sentence that a maker can check at the machine: a cause of the thermoforming model with the
// values of its parameters.
#include <span>
#include <string>
#include <string_view>

namespace formwright {

/// "The sheet was hotter at the front left: about 42 % softer there than in its middle." `cause` as
/// thermoform_causes.cpp names it, `values` of its parameters in their order. Empty for a cause that is not known.
std::string thermoform_cause_in_words(std::string_view cause, std::span<const double> values);

}  // namespace formwright
