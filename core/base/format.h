// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Numbers in sentences and files, the same on every platform and in every locale.
#include <string>

namespace formwright {

/// At most so many significant digits (one or more), no zeros behind them: 0.123, 1.5, 290. Below 0.0001 with a power
/// of ten.
std::string with_digits(double value, int digits);
/// Exactly so many decimals, never a power of ten: %.<decimals>f.
std::string with_decimals(double value, int decimals);
/// As few decimals as are needed, at most so many; never "-0" nor a power of ten.
std::string with_max_decimals(double value, int decimals);

}  // namespace formwright
